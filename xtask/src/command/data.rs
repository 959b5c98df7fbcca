//! `cargo xtask data`: find, fetch and verify the recordings.

use crate::recordings::{Manifest, RECORDED, SIMULATED};
use crate::workspace::Workspace;
use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct DataArguments {
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

impl DataArguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let (asked, data) = (self.convention.as_deref(), self.data.as_deref());
        if asked == Some(SIMULATED) {
            println!("{SIMULATED}: generated on demand, needs no files");
            return Ok(());
        }
        let manifest = Manifest::load(workspace)?;
        let conventions = asked.map_or_else(|| RECORDED.to_vec(), |one| vec![one]);
        let mut present = 0;
        for convention in conventions {
            let entry = manifest.entry(convention)?;
            let located = entry.locate(workspace, convention, data);
            // Wrong files are an error; nothing else may be taken in their place.
            if let (Ok(folder), true) = (&located, self.action != Action::Where) {
                entry.check(folder)?;
            }
            let folder = match self.action {
                // Without a convention: the preferred one that is available.
                Action::Fetch if present > 0 => break,
                Action::Fetch => entry.obtain(workspace, convention, asked, data),
                _ => located,
            };
            present += usize::from(folder.is_ok());
            match folder {
                Ok(folder) => println!("{convention}: {} files in {}", entry.files.len(), folder.display()),
                Err(error) => println!("{convention}: {error:#}"),
            }
            if self.action == Action::Where {
                println!("  {}\n  terms: {}", entry.description, entry.terms);
                let citations = entry.cite.iter().map(|key| &manifest.citation[key]);
                citations.for_each(|citation| println!("  cite: {citation}"));
            }
        }
        ensure!(
            present > 0 || self.action == Action::Where,
            "no recordings (above): fetch them with `cargo xtask data fetch`, or work with `--convention {SIMULATED}`"
        );
        Ok(())
    }
}
