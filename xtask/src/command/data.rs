//! `cargo xtask data`: find, fetch and verify the recordings.

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};

use crate::data::{self, Convention, FETCHED, Manifest, Places};
use crate::workspace::{Workspace, absolute};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// What to do
    action: Action,
    /// One convention only: star or social-gan
    #[arg(long)]
    convention: Option<Convention>,
    /// Folder of the recordings [default: `$DDL_DATASETS`, then `datasets/eth_ucy`]
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Action {
    /// Get the recordings, if they are not there already
    Fetch,
    /// Hash every file that is there and compare it with the manifest
    Verify,
    /// Say which conventions are there, and where
    Where,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        if self.convention == Some(Convention::Simulated) {
            println!("simulated: made on the fly, needs no files");
            return Ok(());
        }
        match self.action {
            Action::Fetch => self.fetch(workspace),
            Action::Verify => self.verify(workspace),
            Action::Where => self.locate(workspace),
        }
    }

    /// Without a convention: the preferred one that can be had.
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
                "no recordings could be had (reasons above); copy them by hand as \
                 docs/recordings.md says, or work with `--convention simulated`"
            ),
        }
    }

    fn verify(&self, workspace: &Workspace) -> Result<()> {
        let manifest = Manifest::load(workspace)?;
        let places = Places::new(workspace, self.data.as_deref())?;
        let mut seen = 0;
        for convention in self.conventions() {
            let Some(entry) = manifest.entry(convention) else {
                continue;
            };
            let Some(folder) = data::lookup(&places, convention, entry) else {
                continue;
            };
            data::check(&folder, entry)
                .with_context(|| format!("{convention} in {}", folder.display()))?;
            println!(
                "{convention}: {} files right, in {}",
                entry.files.len(),
                folder.display()
            );
            seen += 1;
        }
        if seen == 0 {
            bail!(
                "there is nothing to verify in {}: get the recordings with `cargo xtask data \
                 fetch`",
                places.list()
            );
        }
        Ok(())
    }

    fn locate(&self, workspace: &Workspace) -> Result<()> {
        let manifest = Manifest::load(workspace)?;
        let places = Places::new(workspace, self.data.as_deref())?;
        for convention in self.conventions() {
            let Some(entry) = manifest.entry(convention) else {
                continue;
            };
            match data::lookup(&places, convention, entry) {
                Some(folder) => println!("{convention}: {}", folder.display()),
                None => println!("{convention}: not in {}", places.list()),
            }
            println!("  {}", entry.description);
            println!("  terms: {}", entry.terms);
            for citation in manifest.citations(entry) {
                println!("  cite: {citation}");
            }
        }
        Ok(())
    }

    fn conventions(&self) -> Vec<Convention> {
        self.convention
            .map_or_else(|| Convention::RECORDED.to_vec(), |one| vec![one])
    }
}

/// Finds or fetches one convention and says in a line what was done.
pub(super) fn fetch_one(
    workspace: &Workspace,
    convention: Convention,
    folder: Option<&std::path::Path>,
) -> Result<String> {
    let manifest = Manifest::load(workspace)?;
    let entry = manifest
        .entry(convention)
        .context("the simulated crowd has no files")?;
    let count = entry.files.len();
    let places = Places::new(workspace, folder)?;
    if let Some(there) = data::lookup(&places, convention, entry)
        && data::check(&there, entry).is_ok()
    {
        return Ok(format!(
            "{convention}: {count} files are there already, in {}",
            there.display()
        ));
    }
    let folder = folder
        .map_or_else(|| Ok(workspace.path(FETCHED)), absolute)?
        .join(convention.name());
    let source = data::fetch(convention, entry, &folder, &mut |text| eprintln!("{text}"))?;
    let source = source.unwrap_or("an earlier run");
    Ok(format!(
        "{convention}: {count} files, hashes right, from {source}, in {}",
        folder.display()
    ))
}
