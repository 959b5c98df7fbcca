//! The program `ddl` as a library, for programs that embed it. It parses arguments and prints; the crate `ddl` does the
//! work.

mod command;
mod interrupt;
mod kept_inputs;
mod output;
mod paths;
mod progress;
mod recordings;
mod result_lines;
mod small_file;
mod telling;
mod tracks;
mod units;

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use std::ffi::OsString;

/// Forecasts of pedestrians, along stable paths to their goals.
// A test checks that the help fits a screen of 24 lines of 80 columns.
#[derive(Debug, Parser)]
#[command(
    name = "ddl",
    version,
    arg_required_else_help = true,
    disable_help_subcommand = true,
    help_template = "{about}\n\n{usage-heading} {usage}\n\n{subcommands}{after-help}",
    after_help = "Trained models come with the program: `ddl forecast tracks.csv` works at once.\n\
    `ddl COMMAND --help` lists options. Exit codes: 0 success, 1 failure, 2 wrong\n\
    arguments, 130 interrupted (the same command resumes a training)."
)]
struct Cli {
    #[command(subcommand)]
    command: ProgramCommand,
}

#[derive(Debug, Subcommand)]
enum ProgramCommand {
    Forecast(command::forecast::ForecastCommand),
    Risk(command::risk::RiskCommand),
    Occupancy(command::occupancy::OccupancyCommand),
    View(command::view::ViewCommand),
    Goals(command::goals::Goals),
    Data(command::data::Data),
    Train(command::train::Train),
    Evaluate(command::evaluate::Evaluate),
    Report(command::report::ReportCommand),
    Benchmark(Box<command::benchmark::Benchmark>),
    Windows(command::windows::WindowsCommand),
    Pack(command::pack::Pack),
    Info(command::info::Info),
    Completions(command::completions::Completions),
}

/// Runs the program `ddl` with `arguments`, starting with the name of the program. Returns its exit code: 0 success, 1
/// failure, 130 interrupted.
///
/// Writes to the process's standard output and standard error. Arguments that cannot be parsed end the process with
/// exit code 2, `--help` and `--version` with 0.
pub fn run<A: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> u8 {
    ddl::word_settings(|name, value| {
        let option = format!("--{}", name.replace('_', "-"));
        value.map_or(option.clone(), |value| format!("{option} {value}"))
    });
    let matches = Cli::command().get_matches_from(arguments);
    let command =
        Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.format(&mut Cli::command()).exit()).command;
    let kept = kept_inputs::ensure_kept(&Cli::command(), &matches);
    match kept.and_then(|()| run_command(command)) {
        Ok(()) => 0,
        // for example `ddl info | head -1`
        Err(error) if telling::reader_has_gone(&error) => 0,
        Err(error) => {
            let interrupted = matches!(error.downcast_ref::<ddl::DdlError>(), Some(ddl::DdlError::Interrupted));
            let source = if interrupted { "ddl" } else { "error" };
            telling::tell(format_args!("{source}: {}", telling::words(&error)));
            if interrupted { 130 } else { 1 }
        }
    }
}

fn run_command(command: ProgramCommand) -> anyhow::Result<()> {
    match command {
        ProgramCommand::Forecast(command) => command.run(),
        ProgramCommand::Risk(command) => command.run(),
        ProgramCommand::Occupancy(command) => command.run(),
        ProgramCommand::View(command) => command.run(),
        ProgramCommand::Goals(command) => command.run(),
        ProgramCommand::Data(command) => command.run(),
        ProgramCommand::Train(command) => command.run(),
        ProgramCommand::Evaluate(command) => command.run(),
        ProgramCommand::Report(command) => command.run(),
        ProgramCommand::Benchmark(command) => command.run(),
        ProgramCommand::Windows(command) => command.run(),
        ProgramCommand::Pack(command) => command.run(),
        ProgramCommand::Info(command) => command.run(),
        ProgramCommand::Completions(command) => command.run(Cli::command()),
    }
}
