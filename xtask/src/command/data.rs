//! `cargo xtask data`: find, fetch and verify the recordings.

use std::path::PathBuf;

use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};

use crate::recordings::{Manifest, RECORDED, SIMULATED};
use crate::workspace::Workspace;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Action on the recordings
    action: Action,
    /// Only this convention: star or social-gan
    #[arg(long)]
    convention: Option<String>,
    /// Folder of the recordings [default: `$DDL_DATASETS`, then `datasets/eth_ucy`]
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Action {
    /// Fetch the recordings, unless they are already present
    Fetch,
    /// Hash all files and compare them with the manifest
    Verify,
    /// List the available conventions and their folders
    Where,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        if self.convention.as_deref() == Some(SIMULATED) {
            println!("{SIMULATED}: generated on demand, needs no files");
            return Ok(());
        }
        let manifest = Manifest::load(workspace)?;
        let conventions = self
            .convention
            .as_deref()
            .map_or_else(|| RECORDED.to_vec(), |one| vec![one]);
        let mut reasons = Vec::new();
        for convention in &conventions {
            let entry = manifest.entry(convention)?;
            let folder = match self.action {
                Action::Fetch => entry
                    .obtain(workspace, convention, self.data.as_deref())
                    .map(|(folder, _)| folder),
                _ => entry.locate(workspace, convention, self.data.as_deref()),
            };
            match &folder {
                Ok(folder) if self.action == Action::Where => println!("{convention}: {}", folder.display()),
                Err(error) if self.action == Action::Where => println!("{convention}: {error}"),
                Ok(folder) => {
                    entry.check(folder)?;
                    println!(
                        "{convention}: {} files verified in {}",
                        entry.files.len(),
                        folder.display()
                    );
                }
                Err(error) => reasons.push(format!("{error:#}")),
            }
            match self.action {
                // Without a convention: the preferred one that is available.
                Action::Fetch if folder.is_ok() => return Ok(()),
                Action::Where => {
                    println!("  {}\n  terms: {}", entry.description, entry.terms);
                    entry
                        .cite
                        .iter()
                        .for_each(|key| println!("  cite: {}", manifest.citation[key]));
                }
                _ => {}
            }
        }
        ensure!(
            reasons.len() < conventions.len(),
            "no recordings: fetch them with `cargo xtask data fetch`, or work with `--convention {SIMULATED}` ({})",
            reasons.join("; ")
        );
        Ok(())
    }
}
