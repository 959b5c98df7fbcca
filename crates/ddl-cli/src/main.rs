//! The program `ddl`.

fn main() -> std::process::ExitCode {
    ddl_cli::run(std::env::args_os()).into()
}
