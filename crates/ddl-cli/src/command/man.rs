//! `ddl man`.

use crate::output;
use anyhow::Context as _;
use clap::{Args, Command};
use clap_mangen::Man as Page;
use std::path::PathBuf;

/// Write the manual pages: ddl(1) and one a command
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  ddl man ~/.local/share/man/man1 && man ddl-forecast")]
pub(crate) struct Man {
    /// Folder to write to, which is made if need be [default: ddl(1) on standard output]
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
