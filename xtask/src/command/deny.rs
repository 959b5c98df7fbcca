//! `cargo xtask deny`: checks the dependencies against `deny.toml` with cargo-deny.

use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::cargo_tool::CargoTool;
use crate::workspace::Workspace;

/// The version that `deny.toml` was written for.
const TOOL: CargoTool = CargoTool {
    name: "cargo-deny",
    version: "0.20.2",
    options: &[],
    version_call: &["--version"],
};
/// Checks that need no network once the dependencies are present. Advisories are left out, because their database
/// changes daily.
const CHECKS: [&str; 3] = ["bans", "licenses", "sources"];

pub(crate) fn run(workspace: &Workspace) -> Result<()> {
    let tool = TOOL.ensure(workspace)?;
    // The list has the dependencies of every platform; a build here fetched only some of them.
    let fetched = workspace
        .cargo_process()
        .args(["fetch", "--locked", "--quiet"])
        .status()
        .context("cargo cannot be started")?;
    if !fetched.success() {
        bail!(
            "`cargo fetch --locked` failed (above): connect to the package index, or run `cargo update --workspace` if \
             Cargo.lock is out of date"
        );
    }
    let status = Command::new(&tool)
        .current_dir(workspace.root())
        .args(["--offline", "--locked", "--all-features", "check"])
        .args(CHECKS)
        .status()
        .with_context(|| format!("{} cannot be started", tool.display()))?;
    if !status.success() {
        bail!("deny.toml forbids a dependency (above): remove it, or allow it in deny.toml with a reason");
    }
    Ok(())
}
