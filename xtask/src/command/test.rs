//! `cargo xtask test`: all tests of the workspace.

use std::env;
use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::Args;

use super::data::fetch_one;
use super::set_up;
use crate::data::{FETCHED, RECORDED};
use crate::workspace::{Workspace, absolute, step};

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
        for convention in RECORDED {
            match fetch_one(workspace, convention, None) {
                Ok(message) => eprintln!("{message}"),
                Err(error) => eprintln!("{error:#}"),
            }
        }
        // One build of everything: another selection of packages would select other features of their dependencies.
        // It includes the examples, which the tests of `ddl-tests` run.
        cargo_test(workspace, &["--workspace", "--exclude", "ddl-star"], &self.rest)?;
        if self.no_torch {
            return Ok(());
        }
        // The tests that need libtorch.
        let packages = ["-p", "ddl-star", "-p", "ddl-forecast", "-p", "ddl-cli"];
        let arguments = [&packages[..], &["--features", "ddl-cli/torch"]].concat();
        for targets in ["--tests", "--doc"] {
            cargo_test(workspace, &[&arguments[..], &[targets]].concat(), &self.rest)?;
        }
        let tests = ["--features", "torch", "--test", "it_torch", "--test", "faults_torch"];
        cargo_test(workspace, &[&["-p", "ddl-tests"][..], &tests].concat(), &self.rest)
    }
}

/// All tests, after set-up and fetching: the last step of `ci`.
pub(super) fn run_all(workspace: &Workspace) -> Result<()> {
    Arguments {
        no_torch: false,
        rest: Vec::new(),
    }
    .run(workspace)
}

fn cargo_test(workspace: &Workspace, selection: &[&str], rest: &[String]) -> Result<()> {
    let mut command = workspace
        .cargo(["test"])
        .args(selection)
        .args(rest)
        // Tests run in parallel already. One thread each avoids contention for cores and fixes the order of libtorch's
        // sums.
        .env("OMP_NUM_THREADS", "1");
    if let Some(folder) = recordings(workspace)? {
        command = command.env("DDL_DATASETS", folder);
    }
    step("cargo test", &command)
}

/// The folder of recordings, absolute, because every test runs in its own package's folder.
pub(super) fn recordings(workspace: &Workspace) -> Result<Option<PathBuf>> {
    if let Some(folder) = env::var_os("DDL_DATASETS").filter(|value| !value.is_empty()) {
        return absolute(Path::new(&folder)).map(Some);
    }
    Ok(Some(workspace.path(FETCHED)).filter(|folder| folder.is_dir()))
}
