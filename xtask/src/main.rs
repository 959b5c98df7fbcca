//! `cargo xtask`: set-up, recordings, benchmark, tests and tidy checks of this workspace; one file per command under
//! `command/`.
//!
//! The program depends on one of the `ddl` crates, `ddl-data`, and not on libtorch. So it builds on a machine without
//! libtorch and can install it.
#![allow(clippy::print_stdout, reason = "a command-line program prints to standard output")]

mod browser;
mod cache;
mod cargo_tool;
mod command;
mod data;
mod debian;
mod digest;
mod libtorch;
mod process;
mod python;
mod site;
mod slurm;
mod tidy;
mod whole_file;
mod workspace;

use std::process::ExitCode;

use clap::Parser;

use crate::command::Command;
use crate::workspace::Workspace;

/// Set-up, recordings, benchmark, tests and tidy checks of the DDL workspace.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let outcome = Workspace::find().and_then(|workspace| arguments.command.run(&workspace));
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
