//! Builds the program `ddl` and finds out where cargo put it.

use std::io::{BufRead as _, BufReader};
use std::path::PathBuf;
use std::process::Stdio;

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::workspace::Workspace;

/// Cargo is asked where the program lies: a target folder may be set in many ways.
pub(in crate::command) fn program(workspace: &Workspace, cargo_profile: &str) -> Result<PathBuf> {
    eprintln!("building ddl ({cargo_profile})");
    let mut child = workspace
        .cargo_process()
        .args([
            "build",
            "--package",
            "ddl-cli",
            "--bin",
            "ddl",
            "--features",
            "torch",
            "--profile",
            cargo_profile,
        ])
        .args(["--message-format", "json-render-diagnostics"])
        .stdout(Stdio::piped())
        .spawn()
        .context("cargo cannot be started")?;
    let stdout = child.stdout.take().context("cargo has no output")?;
    let mut found = None;
    for line in BufReader::new(stdout).lines() {
        let line = line.context("cargo's output cannot be read")?;
        found = executable(&line).or(found);
    }
    let status = child.wait().context("cargo cannot be waited for")?;
    if !status.success() {
        bail!("the program ddl cannot be built (cargo's messages are above)");
    }
    found.context("cargo built ddl but did not say where it is")
}

/// The path of `ddl`, if the line is cargo's message about it.
fn executable(line: &str) -> Option<PathBuf> {
    let message: Value = serde_json::from_str(line).ok()?;
    let is_ddl = message["reason"] == "compiler-artifact" && message["target"]["name"] == "ddl";
    message["executable"]
        .as_str()
        .filter(|_| is_ddl)
        .map(PathBuf::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_is_told_from_the_library_of_the_same_name() {
        let line = |executable: &str| {
            format!(
                r#"{{"reason":"compiler-artifact","target":{{"name":"ddl"}},"executable":{executable}}}"#
            )
        };
        assert_eq!(
            executable(&line("\"/t/debug/ddl\"")),
            Some(PathBuf::from("/t/debug/ddl"))
        );
        assert_eq!(executable(&line("null")), None);
        assert_eq!(
            executable(r#"{"reason":"build-finished","success":true}"#),
            None
        );
        assert_eq!(executable("not json"), None);
    }
}
