//! `cargo xtask`: set-up, recordings, benchmark, tests and tidy checks of this workspace.
//!
//! Of the `ddl` crates the program depends on `ddl-data` alone, and not on libtorch, so it builds on a bare machine
//! within seconds and can bring in the rest. One command, one file under `command/`; what the
//! commands share lies in the rooms beside it:
//!
//! | room | what it knows |
//! |---|---|
//! | `libtorch` | which libtorch is pinned, where it lies, how to get it, how cargo is told |
//! | `data` | which recordings are pinned, where they lie, how to get them |
//! | `site` | the documentation site: what it is made of, and that its links lead somewhere |
//! | `cache` | what is kept from one call to the next |
//! | `browser` | where a browser is or how to get one, and what drives it |
//! | `cargo_tool` | programs of other people that checks run, one pinned version each |
//! | `tidy` | house rules that no other tool checks |
#![allow(
    clippy::print_stdout,
    reason = "a command-line program answers on standard output"
)]

mod browser;
mod cache;
mod cargo_tool;
mod command;
mod data;
mod digest;
mod libtorch;
mod python;
mod site;
mod tidy;
mod whole_file;
mod workspace;

use std::process::ExitCode;

use clap::Parser;

use crate::command::Command;
use crate::workspace::Workspace;

/// Set-up, recordings, benchmark, tests and tidy checks of the DDL workspace.
#[derive(Debug, Parser)]
#[command(
    name = "cargo xtask",
    bin_name = "cargo xtask",
    version,
    max_term_width = 100
)]
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
