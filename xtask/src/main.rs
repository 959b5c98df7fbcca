//! `cargo xtask`: set-up, recordings, benchmark, checks and tests of this workspace; one file per command under
//! `command/`.
//!
//! The program depends on no crate of the workspace and not on libtorch. So it is built in seconds on a machine without
//! libtorch and can install it.
#![allow(clippy::print_stdout, reason = "a command-line program prints to standard output")]

mod browser;
mod cache;
mod command;
mod debian;
mod libtorch;
mod process;
mod python;
mod recordings;
mod rust_target;
mod tidy;
mod tools;
mod workspace;

use crate::command::XtaskCommand;
use crate::workspace::Workspace;
use clap::Parser;
use std::process::ExitCode;

/// Set-up, recordings, benchmark, checks and tests of the DDL workspace.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: XtaskCommand,
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
