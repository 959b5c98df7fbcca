//! mdBook, which makes the guide's pages: one pinned version, built once into `target/tools`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context, Result, bail};

use crate::workspace::Workspace;

/// The version the theme was written for.
const VERSION: &str = "0.5.4";

/// What shortens the build: the program renders some thirty pages.
const PROFILE: [(&str, &str); 4] = [
    ("CARGO_PROFILE_RELEASE_OPT_LEVEL", "1"),
    ("CARGO_PROFILE_RELEASE_DEBUG", "false"),
    ("CARGO_PROFILE_RELEASE_LTO", "off"),
    ("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16"),
];

/// The program; the first call builds it, which takes some minutes.
pub(super) fn ensure(workspace: &Workspace) -> Result<PathBuf> {
    let folder = workspace.path(&format!("target/tools/mdbook-{VERSION}"));
    let program = folder
        .join("bin")
        .join(format!("mdbook{}", std::env::consts::EXE_SUFFIX));
    if !program.is_file() {
        install(workspace, &folder)?;
    }
    Ok(program)
}

/// Everything happens in a temporary folder beside it, which takes its name at the very end.
fn install(workspace: &Workspace, folder: &Path) -> Result<()> {
    let start = Instant::now();
    let parent = folder.parent().context("a tool needs a folder")?;
    fs::create_dir_all(parent).with_context(|| format!("{} cannot be made", parent.display()))?;
    let work = tempfile::Builder::new()
        .prefix(".mdbook-incoming-")
        .tempdir_in(parent)
        .with_context(|| format!("{} cannot be written to", parent.display()))?;
    eprintln!("mdbook {VERSION}: building it with cargo, once (some minutes)");
    let root = work.path().join("root");
    let status = workspace
        .cargo_process()
        .args([
            "install",
            "mdbook",
            "--locked",
            "--quiet",
            "--version",
            VERSION,
        ])
        .args(["--no-default-features", "--features", "search", "--root"])
        .arg(&root)
        .arg("--target-dir")
        .arg(work.path().join("build"))
        .envs(PROFILE)
        .stdin(Stdio::null())
        .status()
        .context("cargo cannot be started")?;
    if !status.success() {
        bail!("cargo could not install mdbook {VERSION} (above): connect to a package index");
    }
    match fs::rename(&root, folder) {
        // Somebody else was faster.
        Err(_) if folder.is_dir() => {}
        outcome => outcome.with_context(|| format!("{} cannot be created", folder.display()))?,
    }
    eprintln!(
        "mdbook {VERSION}: {} ({:.0} s)",
        folder.display(),
        start.elapsed().as_secs_f64()
    );
    Ok(())
}

/// Renders the book in `book` into `out`; whatever mdBook complains of is an error.
pub(super) fn render(program: &Path, book: &Path, out: &Path) -> Result<()> {
    let output = Command::new(program)
        .arg("build")
        .arg("--dest-dir")
        .arg(out)
        .arg(book)
        .stdin(Stdio::null())
        .output()
        .with_context(|| format!("{} cannot be started", program.display()))?;
    let said = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() || complains(&said) {
        bail!("mdbook does not accept the guide:\n{}", said.trim());
    }
    Ok(())
}

/// mdBook goes on where an included file is missing, and says so in its log.
fn complains(log: &str) -> bool {
    log.lines()
        .any(|line| line.contains("WARN") || line.contains("ERROR"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_in_the_log_is_seen() {
        assert!(!complains(
            " INFO Book building has started\n INFO Running the html backend\n"
        ));
        assert!(complains(
            "ERROR Error updating \"{{#include nowhere}}\", cannot read\n"
        ));
        assert!(complains(" WARN unclosed HTML tag\n"));
    }
}
