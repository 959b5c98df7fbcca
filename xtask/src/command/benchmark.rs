//! `cargo xtask benchmark`: libtorch, the recordings and the program, then `ddl benchmark`.

use std::fs;
use std::os::unix::process::CommandExt as _;

use anyhow::{Context, Result};
use clap::Args;

use super::set_up;
use crate::process::run;
use crate::recordings::bring_in;
use crate::workspace::Workspace;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Options of `ddl benchmark`, such as `--profile smoke`; paths in them are relative to the checkout
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "OPTIONS")]
    options: Vec<String>,
}

impl Arguments {
    /// Replaces this process by the program, which then receives Ctrl-C and determines the exit code.
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        bring_in(workspace)?;
        set_up(workspace)?;
        let mut cargo =
            workspace.cargo("run --release --package ddl-cli --bin ddl --features torch -- benchmark".split(' '));
        cargo.args(self.options);
        Err(cargo.exec()).context("cargo cannot be started")
    }
}

/// The benchmark as `ci` runs it: small, under every protocol, in a separate folder, from the start, with the program
/// that `ci` has built.
pub(super) fn smoke(workspace: &Workspace) -> Result<()> {
    let out = workspace.path("target/ci-benchmark");
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| format!("{} cannot be deleted", out.display()))?;
    }
    let options = "benchmark --profile smoke --protocol published,fair,single --out target/ci-benchmark";
    run(workspace
        .program(workspace.path("target/debug/ddl"))
        .args(options.split(' ')))
}
