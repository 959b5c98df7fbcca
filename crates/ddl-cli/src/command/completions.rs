//! `ddl completions`: a script generated from the definition of the command line.

use crate::output;
use clap::{Args, Command};
use clap_complete::{Shell, generate};

/// Print a shell script that completes ddl's commands and options
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
        ddl completions bash > ~/.local/share/bash-completion/completions/ddl\n  \
        ddl completions zsh > ~/.zfunc/_ddl\n  \
        ddl completions fish > ~/.config/fish/completions/ddl.fish")]
pub(crate) struct Completions {
    /// Shell
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    pub(crate) fn run(self, mut program: Command) -> anyhow::Result<()> {
        let mut script = Vec::new();
        generate(self.shell, &mut program, "ddl", &mut script);
        output::print(std::str::from_utf8(&script)?)
    }
}
