//! `ddl completions` and `ddl man`: output generated from the definition of the command line.

use crate::output;
use anyhow::Context as _;
use clap::{Args, Command};
use clap_complete::{Shell, generate};
use clap_mangen::Man as Page;
use std::path::PathBuf;

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

/// Write the manual pages: ddl(1) and one for each command
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  ddl man ~/.local/share/man/man1 && man ddl-forecast")]
pub(crate) struct Man {
    /// Folder to write to, created if missing [default: print ddl(1) to standard output]
    #[arg(value_name = "FOLDER")]
    folder: Option<PathBuf>,
}

impl Man {
    pub(crate) fn run(self, program: Command) -> anyhow::Result<()> {
        let Some(folder) = self.folder else {
            return output::print(&page(program)?);
        };
        std::fs::create_dir_all(&folder)
            .and_then(|()| clap_mangen::generate_to(program, &folder))
            .with_context(|| format!("cannot write manual pages to {}", folder.display()))
    }
}

fn page(command: Command) -> anyhow::Result<String> {
    let mut text = Vec::new();
    Page::new(command).render(&mut text)?;
    Ok(String::from_utf8(text)?)
}
