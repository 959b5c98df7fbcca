//! The program `ddl`: argument parsing and glue; the work is done by the crate `ddl`.

mod command;
mod interrupt;
mod progress;
mod result_lines;
mod tracks;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Forecasts of walking people that converge to their goals.
///
/// A goal is estimated for each pedestrian from similar walkers, a Transformer (STAR) shapes a
/// positive-definite matrix P, and the walker follows v = -P grad Phi to the goal.
#[derive(Debug, Parser)]
#[command(name = "ddl", version, arg_required_else_help = true)]
#[command(
    after_help = "Trained models come with the program: `ddl forecast tracks.csv` works at once.\n\n\
    Exit codes: 0 done, 1 failed, 2 wrong arguments, 130 interrupted (saved)."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Train(command::train::Train),
    Evaluate(command::evaluate::Evaluate),
    Baselines(command::baselines::Baselines),
    Report(command::report::Report),
    Forecast(command::forecast::Forecast),
    Goals(command::goals::Goals),
    Pack(command::pack::Pack),
    Windows(command::windows::Windows),
    Info(command::info::Info),
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Train(command) => command.run(),
        Command::Evaluate(command) => command.run(),
        Command::Baselines(command) => command.run(),
        Command::Report(command) => command.run(),
        Command::Forecast(command) => command.run(),
        Command::Goals(command) => command.run(),
        Command::Pack(command) => command.run(),
        Command::Windows(command) => command.run(),
        Command::Info(command) => command.run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let interrupted = matches!(
                error.downcast_ref::<ddl::DdlError>(),
                Some(ddl::DdlError::Interrupted)
            );
            let who = if interrupted { "ddl" } else { "error" };
            eprintln!("{who}: {}", message(&error));
            ExitCode::from(if interrupted { 130 } else { 1 })
        }
    }
}

/// An error and its causes, each said once: some errors already say their cause themselves.
fn message(error: &anyhow::Error) -> String {
    let mut message = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if !message.contains(&cause) {
            let separator = if message.is_empty() { "" } else { ": " };
            message = message + separator + &cause;
        }
    }
    message
}
