//! The commands, one per file.

mod benchmark;
mod c;
mod ci;
mod data;
mod docs;
mod hook;
mod nightly;
mod python;
mod release;
mod setup;
mod test;
mod web;

use crate::libtorch::{self, LibtorchRequest};
use crate::workspace::Workspace;
use anyhow::Result;
use clap::Subcommand;

/// The commands of `cargo xtask`.
#[derive(Debug, Subcommand)]
pub(crate) enum XtaskCommand {
    /// Install libtorch, so that plain `cargo build`, `test`, `run` and `doc` work
    Setup(setup::SetupArguments),
    /// Find, fetch and verify the ETH/UCY recordings
    Data(data::DataArguments),
    /// Train and evaluate every fold and write the report: set-up and recordings, then `ddl benchmark`
    Benchmark(benchmark::BenchmarkArguments),
    /// Run every test
    Test(test::TestArguments),
    /// Check format, spelling, links, tidy rules and lints, without libtorch: under a minute once it has been built
    Check,
    /// Check format, columns and spelling of what is staged, as git does before a commit
    Hook,
    /// Run all checks that must pass before a change is merged
    Ci,
    /// Build the wheel of the Python package and test it in a virtual environment
    Python(python::PythonArguments),
    /// Build everything that a version consists of; without --dry-run, publish it
    Release(release::ReleaseArguments),
    /// Build and install the library for C and C++
    C(c::CLibraryArguments),
    /// Build the page and the npm package that forecast in a browser
    Web(web::WebArguments),
    /// Build the documentation site: the guide and every crate's interface, with every link checked
    Docs,
    /// Run what takes too long for `ci`; without a name, list it
    Nightly(nightly::NightlyArguments),
}

impl XtaskCommand {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        match self {
            Self::Setup(arguments) => arguments.run(workspace),
            Self::Data(arguments) => arguments.run(workspace),
            Self::Benchmark(arguments) => arguments.run(workspace),
            Self::Test(arguments) => arguments.run(workspace),
            Self::Check => ci::check(workspace),
            Self::Hook => hook::run(workspace),
            Self::Ci => ci::run(workspace),
            Self::Python(arguments) => arguments.run(workspace),
            Self::Release(arguments) => arguments.run(workspace),
            Self::C(arguments) => arguments.run(workspace),
            Self::Web(arguments) => arguments.run(workspace),
            Self::Docs => docs::print(workspace),
            Self::Nightly(arguments) => arguments.run(workspace),
        }
    }
}

/// Set-up before a command that builds; silent if nothing had to be done.
fn set_up(workspace: &Workspace) -> Result<()> {
    let ready = libtorch::ensure(workspace, &LibtorchRequest::default())?;
    if ready.reconfigured || ready.origin == libtorch::FETCHED {
        let folder = ready.folder.display();
        eprintln!("libtorch {}: {folder} ({})", libtorch::VERSION, ready.origin);
    }
    Ok(())
}
