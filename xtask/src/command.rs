//! The commands, one per file.

mod benchmark;
mod check;
mod ci;
mod cluster;
mod data;
mod deny;
mod docs;
mod faults;
mod fuzz;
mod mutants;
mod package;
mod page;
mod python;
mod setup;
mod test;

use anyhow::Result;
use clap::Subcommand;

use crate::libtorch::{self, Origin, Request};
use crate::tidy;
use crate::workspace::Workspace;

/// The commands of `cargo xtask`.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Install libtorch, so that plain `cargo build`, `test`, `run` and `doc` work
    Setup(setup::Arguments),
    /// Print shell lines that set libtorch's variables, for tools that do not use cargo's configuration
    Env,
    /// Find, fetch and verify the ETH/UCY recordings
    Data(data::Arguments),
    /// Train and evaluate every fold and write the report: set-up and recordings, then `ddl benchmark`
    Benchmark(benchmark::Arguments),
    /// Create the report page of the simulated crowds and check it in a browser
    Page(page::Arguments),
    /// Test the program with killed processes, full disks, damaged files and large crowds, and print a table
    Faults(faults::Arguments),
    /// Check the benchmark on a real Slurm of two nodes on this machine
    Cluster,
    /// Build the documentation site: the guide and every crate's interface, with every link checked
    Docs(docs::Arguments),
    /// Run every test
    Test(test::Arguments),
    /// Fuzz the readers of untrusted input
    Fuzz(fuzz::Arguments),
    /// Insert faults into the numeric code, one at a time, and count how many the tests find
    Mutants(mutants::Arguments),
    /// Check format, tidy rules and lints, without libtorch: under a minute once it has been built
    Check,
    /// Check rules that no other tool checks: names, sizes, columns, words, links
    Tidy,
    /// Check the dependencies against deny.toml
    Deny,
    /// Build the wheel of the Python package and test it in a virtual environment
    Python(python::Arguments),
    /// Pack the crates as for a registry and check the contents of the packages
    Package(package::Arguments),
    /// Run all checks that must pass before a change is merged: format, tidy, lints, docs, tests
    Ci,
}

impl Command {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        match self {
            Self::Setup(arguments) => arguments.run(workspace),
            Self::Env => setup::print_environment(workspace),
            Self::Data(arguments) => arguments.run(workspace),
            Self::Benchmark(arguments) => arguments.run(workspace),
            Self::Faults(arguments) => arguments.run(workspace),
            Self::Page(arguments) => arguments.run(workspace),
            Self::Cluster => cluster::run(workspace),
            Self::Docs(arguments) => arguments.run(workspace),
            Self::Test(arguments) => arguments.run(workspace),
            Self::Fuzz(arguments) => arguments.run(workspace),
            Self::Mutants(arguments) => arguments.run(workspace),
            Self::Check => check::run(workspace),
            Self::Tidy => tidy::run(workspace),
            Self::Deny => deny::run(workspace),
            Self::Python(arguments) => arguments.run(workspace),
            Self::Package(arguments) => arguments.run(workspace),
            Self::Ci => ci::run(workspace),
        }
    }
}

/// Set-up before a command that builds; silent if nothing had to be done.
fn set_up(workspace: &Workspace) -> Result<()> {
    let ready = libtorch::ensure(workspace, &Request::default())?;
    if ready.reconfigured || ready.origin == Origin::Fetched {
        eprintln!(
            "libtorch {}: {} ({})",
            libtorch::VERSION,
            ready.folder.display(),
            ready.origin
        );
    }
    Ok(())
}
