//! `cargo xtask test`: all tests of the workspace.

use anyhow::Result;
use clap::Args;

use super::set_up;
use crate::process::run;
use crate::recordings::{Manifest, RECORDED};
use crate::workspace::Workspace;

/// One build of everything without libtorch: another selection of packages would select other features of their
/// dependencies. It includes the examples, which the tests of `ddl-tests` run.
const PLAIN: &str = "--workspace --exclude ddl-star";
/// The tests that need libtorch.
const TORCH: [&str; 3] = [
    "-p ddl-star -p ddl-forecast -p ddl-cli --features ddl-cli/torch --tests",
    "-p ddl-star -p ddl-forecast -p ddl-cli --features ddl-cli/torch --doc",
    "-p ddl-tests --features torch --test it_torch --test faults_torch",
];

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Only tests that need no libtorch; nothing is set up
    #[arg(long)]
    no_torch: bool,
    /// Passed to `cargo test`, as in `-- --release some_test`
    #[arg(last = true)]
    rest: Vec<String>,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        if !self.no_torch {
            set_up(workspace)?;
        }
        // Best effort: a test that needs recordings prints what is missing, and fails in CI.
        let manifest = Manifest::load(workspace)?;
        for convention in RECORDED {
            match manifest.entry(convention)?.obtain(workspace, convention, None) {
                Ok((_, reason)) => eprintln!("{convention}: {reason}"),
                Err(error) => eprintln!("{error:#}"),
            }
        }
        cargo_test(workspace, PLAIN, &self.rest)?;
        if self.no_torch {
            return Ok(());
        }
        TORCH
            .iter()
            .try_for_each(|selection| cargo_test(workspace, selection, &self.rest))
    }
}

/// All tests, after set-up and fetching: the last step of `ci`.
pub(super) fn run_all(workspace: &Workspace) -> Result<()> {
    let arguments = Arguments {
        no_torch: false,
        rest: Vec::new(),
    };
    arguments.run(workspace)
}

fn cargo_test(workspace: &Workspace, selection: &str, rest: &[String]) -> Result<()> {
    let mut tests = workspace.cargo(["test"]);
    tests
        .args(selection.split(' '))
        .args(rest)
        // Tests run in parallel already. One thread each avoids contention for cores and fixes the order of libtorch's
        // sums.
        .env("OMP_NUM_THREADS", "1");
    if let Some(folder) = workspace.recordings()? {
        tests.env("DDL_DATASETS", folder);
    }
    run(&mut tests)
}
