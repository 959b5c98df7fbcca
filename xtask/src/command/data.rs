//! `cargo xtask data`: find, fetch and verify the recordings.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use ddl_data::{Convention, locate};

use crate::data::{self, Manifest, RECORDED};
use crate::workspace::Workspace;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Action on the recordings
    action: Action,
    /// Only this convention: star or social-gan
    #[arg(long)]
    convention: Option<Convention>,
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
        if self.convention == Some(Convention::Simulated) {
            println!("simulated: generated on demand, needs no files");
            return Ok(());
        }
        match self.action {
            Action::Fetch => self.fetch(workspace),
            Action::Verify => self.verify(workspace),
            Action::Where => self.locate(workspace),
        }
    }

    /// Without a convention: the preferred one that is available.
    fn fetch(&self, workspace: &Workspace) -> Result<()> {
        let mut reasons = Vec::new();
        for convention in self.conventions() {
            match fetch_one(workspace, convention, self.data.as_deref()) {
                Ok(message) => {
                    println!("{message}");
                    return Ok(());
                }
                Err(error) => {
                    if self.convention.is_none() {
                        eprintln!("{convention}: {error:#}");
                    }
                    reasons.push(error);
                }
            }
        }
        match (self.convention, reasons.pop()) {
            (Some(_), Some(error)) => Err(error),
            _ => bail!(
                "no recordings could be fetched (reasons above); copy them by hand as \
                 docs/recordings.md says, or work with `--convention simulated`"
            ),
        }
    }

    fn verify(&self, workspace: &Workspace) -> Result<()> {
        let manifest = Manifest::load(workspace)?;
        let mut absent = Vec::new();
        for convention in self.conventions() {
            let folder = match locate(convention, self.data.as_deref()) {
                Ok(folder) => folder,
                Err(error) => {
                    absent.push(error.to_string());
                    continue;
                }
            };
            let entry = manifest.entry(convention)?;
            data::check(&folder, entry).with_context(|| format!("{convention} in {}", folder.display()))?;
            let files = entry.files.len();
            println!("{convention}: {files} files verified in {}", folder.display());
        }
        if absent.len() == self.conventions().len() {
            bail!(
                "no recordings to verify: fetch them with `cargo xtask data fetch` ({})",
                absent.join("; ")
            );
        }
        Ok(())
    }

    fn locate(&self, workspace: &Workspace) -> Result<()> {
        let manifest = Manifest::load(workspace)?;
        for convention in self.conventions() {
            match locate(convention, self.data.as_deref()) {
                Ok(folder) => println!("{convention}: {}", folder.display()),
                Err(error) => println!("{convention}: {error}"),
            }
            let entry = manifest.entry(convention)?;
            println!("  {}", entry.description);
            println!("  terms: {}", entry.terms);
            for citation in manifest.citations(entry) {
                println!("  cite: {citation}");
            }
        }
        Ok(())
    }

    fn conventions(&self) -> Vec<Convention> {
        self.convention.map_or_else(|| RECORDED.to_vec(), |one| vec![one])
    }
}

pub(super) fn fetch_one(workspace: &Workspace, convention: Convention, folder: Option<&Path>) -> Result<String> {
    if let Ok(Some(there)) = data::find_right(workspace, convention, folder) {
        return Ok(format!(
            "{convention}: the files are already present in {}",
            there.display()
        ));
    }
    let say = &mut |text: &str| eprintln!("{text}");
    let (folder, source) = data::fetch_to(workspace, convention, folder, say)?;
    Ok(format!(
        "{convention}: fetched from {source} to {}, hashes verified",
        folder.display()
    ))
}
