//! `cargo xtask test`: all tests of the workspace.
//!
//! Every build here selects the whole workspace with its tests, so that cargo chooses one set of features for the
//! dependencies and compiles each crate once. Only what depends on the feature `torch` is compiled twice.

use super::set_up;
use crate::process::run;
use crate::recordings::bring_in;
use crate::workspace::Workspace;
use anyhow::Result;
use clap::Args;

/// Everything that can be built without the feature `torch`.
const PLAIN: &str = "--workspace --lib --bins --examples --tests";
/// The program, its tests and the examples of the documentation with the feature `torch`.
const TORCH: &str = "--workspace --features ddl-cli/torch,ddl-tests/torch";
const TORCH_TESTS: &str = "--test it_torch";

#[derive(Debug, Default, Args)]
pub(crate) struct TestArguments {
    /// Only tests that need no libtorch; nothing is set up
    #[arg(long)]
    no_torch: bool,
    /// Passed to `cargo test`, as in `-- --release some_test`
    #[arg(last = true)]
    rest: Vec<String>,
}

impl TestArguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        if !self.no_torch {
            set_up(workspace)?;
        }
        bring_in(workspace)?;
        if self.no_torch {
            return cargo(workspace, "test", "--workspace --exclude ddl-star", &self.rest);
        }
        build_with_torch(workspace)?;
        cargo(workspace, "test", &format!("{TORCH} {TORCH_TESTS}"), &self.rest)?;
        cargo(workspace, "test", &format!("{TORCH} --doc"), &self.rest)?;
        build(workspace)?;
        cargo(workspace, "test", "--workspace --tests", &self.rest)
    }
}

/// Everything without libtorch: the tests, `target/debug/ddl`, the examples, the library of the Python package.
pub(super) fn build(workspace: &Workspace) -> Result<()> {
    cargo(workspace, "build", PLAIN, &[])
}

/// The program with libtorch, as `target/debug/ddl`, and its tests.
pub(super) fn build_with_torch(workspace: &Workspace) -> Result<()> {
    cargo(workspace, "build", &format!("{TORCH} --bin ddl {TORCH_TESTS}"), &[])
}

fn cargo(workspace: &Workspace, action: &str, selection: &str, rest: &[String]) -> Result<()> {
    let mut cargo = workspace.cargo([action]);
    cargo
        .args(selection.split(' '))
        .args(rest)
        // Tests run in parallel already. One thread each avoids contention for cores and fixes the order of libtorch's
        // sums.
        .env("OMP_NUM_THREADS", "1");
    if let Some(folder) = workspace.recordings()? {
        cargo.env("DDL_DATASETS", folder);
    }
    run(&mut cargo)
}
