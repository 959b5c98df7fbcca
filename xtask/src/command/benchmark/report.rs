//! The report over all finished runs, with the baselines of the other data convention beside it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::benchmark::{PUBLISHED_PROTOCOL, Plan};
use crate::data::{self, Convention};
use crate::workspace::Workspace;

/// Has the program write the report, and prints it.
pub(super) fn write(
    workspace: &Workspace,
    plan: &Plan,
    program: &Path,
    runs: &[PathBuf],
    out: &Path,
) -> Result<()> {
    let mut folders = runs.to_vec();
    folders.extend(baselines_elsewhere(workspace, plan, program, out)?);
    let settings = &plan.settings;
    let title = format!(
        "Benchmark: {}, {}, recipe {}",
        settings.convention, settings.profile, settings.recipe.name
    );
    let mut command = Command::new(program);
    command
        .arg("report")
        .args(&folders)
        .args(["--title", &title, "--out"])
        .arg(out);
    call(&mut command, "report")?;
    let file = out.join("report.md");
    let text =
        fs::read_to_string(&file).with_context(|| format!("{} cannot be read", file.display()))?;
    println!("\n{}\n", text.trim_end());
    for (what, name) in [
        ("report", "report.md"),
        ("", "report.json"),
        ("for a paper", "report.tex"),
        ("to look at", "report.html"),
        ("figures", "figures"),
    ] {
        println!("{what:12} {}", out.join(name).display());
    }
    Ok(())
}

/// The baselines in the recorded convention that the plan is not in, if its recordings are on this machine: how far apart the
/// two are is seen best where nothing is trained.
fn baselines_elsewhere(
    workspace: &Workspace,
    plan: &Plan,
    program: &Path,
    out: &Path,
) -> Result<Option<PathBuf>> {
    let settings = &plan.settings;
    // A choice with the truth says nothing about baselines: they are measured under the others.
    let protocols = settings
        .protocols
        .iter()
        .filter(|name| *name != PUBLISHED_PROTOCOL);
    let protocols: Vec<&String> = protocols.collect();
    if settings.convention == Convention::Simulated.name() || protocols.is_empty() {
        return Ok(None);
    }
    let others = Convention::RECORDED
        .into_iter()
        .filter(|convention| convention.name() != settings.convention);
    for convention in others {
        let Some(recordings) = data::at_hand(workspace, convention, settings.data.as_deref())?
        else {
            continue;
        };
        let folder = out.join(format!("baselines-{convention}"));
        let mut command = Command::new(program);
        command
            .args(["baselines", "--convention", convention.name(), "--data"])
            .arg(recordings)
            .args(["--progress", "json", "--out"])
            .arg(&folder)
            .env("DDL_COMMIT", workspace.commit());
        for protocol in &protocols {
            command.args(["--protocol", protocol.as_str()]);
        }
        if let Some(walkers) = settings.test_walkers {
            command.args(["--test-walkers", &walkers.to_string()]);
        }
        call(&mut command, "baselines")?;
        return Ok(Some(folder));
    }
    Ok(None)
}

fn call(command: &mut Command, name: &str) -> Result<()> {
    let output = command
        .output()
        .with_context(|| format!("{} cannot be started", command.get_program().display()))?;
    if !output.status.success() {
        bail!(
            "`ddl {name}` ended with {}: {}",
            output.status,
            String::from_utf8_lossy(&output.stderr).trim_end()
        );
    }
    Ok(())
}
