//! Recordings: the pinned files of `datasets/manifest.toml`, found or fetched. The choice of a data convention.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use serde::{Deserialize, Serialize};

use crate::cache::sha256;
use crate::process::read;
use crate::python::Python;
use crate::workspace::{Workspace, absolute};

const MANIFEST: &str = "datasets/manifest.toml";
/// Folder of fetched recordings, relative to the workspace root.
pub(crate) const FETCHED: &str = "datasets/eth_ucy";
/// The conventions with files, in order of preference.
pub(crate) const RECORDED: [&str; 2] = ["star", "social-gan"];
/// The convention that needs no files.
pub(crate) const SIMULATED: &str = "simulated";
const FETCH: &str = include_str!("python/fetch.py");

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Manifest {
    star: Entry,
    #[serde(rename = "social-gan")]
    social_gan: Entry,
    pub(crate) citation: BTreeMap<String, String>,
}

/// The recordings of one convention.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Entry {
    pub(crate) description: String,
    pub(crate) terms: String,
    /// Keys of the manifest's citations.
    pub(crate) cite: Vec<String>,
    /// Tried in order until one has every file; read by `python/fetch.py`.
    source: Vec<BTreeMap<String, toml::Value>>,
    #[serde(rename = "file")]
    pub(crate) files: Vec<PinnedFile>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PinnedFile {
    /// Its name in a folder of recordings.
    pub(crate) name: String,
    /// Replaces `{path}` in the address of a source.
    path: String,
    bytes: u64,
    pub(crate) sha256: String,
}

#[derive(Debug)]
pub(crate) struct Chosen {
    pub(crate) convention: String,
    pub(crate) folder: Option<PathBuf>,
    /// The reason for this choice: a clause.
    pub(crate) reason: String,
}

impl Manifest {
    pub(crate) fn load(workspace: &Workspace) -> Result<Self> {
        let text = fs::read_to_string(workspace.path(MANIFEST)).with_context(|| MANIFEST.to_owned())?;
        toml::from_str(&text).with_context(|| format!("{MANIFEST} is not well formed"))
    }

    pub(crate) fn entry(&self, convention: &str) -> Result<&Entry> {
        match convention {
            "star" => Ok(&self.star),
            "social-gan" => Ok(&self.social_gan),
            _ => bail!(
                "no recordings of {convention:?} can be fetched: name one of {}",
                RECORDED.join(", ")
            ),
        }
    }
}

impl Entry {
    /// The folder with the files of this convention, found by their names as `ddl` does: in `data` if given, else in
    /// `$DDL_DATASETS`, else in `datasets/eth_ucy`; there, in a sub-folder of this name, or in one beside it.
    pub(crate) fn locate(&self, workspace: &Workspace, convention: &str, data: Option<&Path>) -> Result<PathBuf> {
        let root = match data {
            Some(folder) => absolute(folder)?,
            None => workspace.recordings()?.unwrap_or_else(|| workspace.path(FETCHED)),
        };
        let mut folders = vec![root.clone(), root.join(convention)];
        if RECORDED.iter().any(|name| root.ends_with(name)) {
            folders.extend(root.parent().map(|parent| parent.join(convention)));
        }
        let has_all = |folder: &PathBuf| self.files.iter().all(|file| folder.join(&file.name).is_file());
        let folder = folders.into_iter().find(has_all);
        folder.with_context(|| format!("the {convention} recordings are not in {}", root.display()))
    }

    /// The files that are not in the folder with their pinned contents.
    fn wrong_in(&self, folder: &Path) -> Vec<&PinnedFile> {
        let is_wrong = |file: &&PinnedFile| sha256(&folder.join(&file.name)).ok().as_ref() != Some(&file.sha256);
        self.files.iter().filter(is_wrong).collect()
    }

    pub(crate) fn check(&self, folder: &Path) -> Result<()> {
        let wrong: Vec<&str> = self.wrong_in(folder).iter().map(|file| file.name.as_str()).collect();
        ensure!(
            wrong.is_empty(),
            "{} of {} files in {} are not the pinned recordings ({}): delete them, then run `cargo xtask data fetch`",
            wrong.len(),
            self.files.len(),
            folder.display(),
            wrong.join(", ")
        );
        Ok(())
    }

    /// The folder of the recordings, found or fetched, and a clause that describes it. Wrong files are an error:
    /// nothing may replace them silently.
    pub(crate) fn obtain(
        &self,
        workspace: &Workspace,
        convention: &str,
        data: Option<&Path>,
    ) -> Result<(PathBuf, String)> {
        if let Ok(folder) = self.locate(workspace, convention, data) {
            self.check(&folder)?;
            let reason = format!("its files are in {}, hashes verified", folder.display());
            return Ok((folder, reason));
        }
        let folder = data
            .map_or_else(|| Ok(workspace.path(FETCHED)), absolute)?
            .join(convention);
        let source = self.fetch(convention, &folder)?;
        let reason = format!("its files are in {}, from {source}, hashes verified", folder.display());
        Ok((folder, reason))
    }

    /// Puts every missing or wrong file into `folder`, from the first source of the manifest that has it. Returns the
    /// source's name.
    fn fetch(&self, convention: &str, folder: &Path) -> Result<&str> {
        let python = Python::find()?;
        let made = fs::create_dir_all(folder).and_then(|()| tempfile::tempdir_in(folder));
        let work = made.with_context(|| format!("{} cannot be written to", folder.display()))?;
        let mut reasons = Vec::new();
        let mut name = "an earlier run";
        for source in &self.source {
            let missing = self.wrong_in(folder);
            if missing.is_empty() {
                break;
            }
            name = source["name"].as_str().unwrap_or_default();
            eprintln!("{convention}: fetching from {name}");
            let request = serde_json::json!({ "source": source, "files": missing, "folder": work.path() });
            if let Err(error) = read(&mut python.call(["-c", FETCH, &request.to_string()])) {
                reasons.push(format!("{name}: {error:#}"));
            }
            // Files that arrived before a failure are right and stay.
            for file in missing {
                fs::rename(work.path().join(&file.name), folder.join(&file.name)).ok();
            }
        }
        if self.wrong_in(folder).is_empty() {
            return Ok(name);
        }
        drop(work);
        // Only an empty folder can be removed.
        fs::remove_dir(folder).ok();
        bail!(
            "the {convention} recordings cannot be fetched ({}); check the network, or copy them by hand \
             (docs/recordings.md)",
            reasons.join("; ")
        )
    }
}

/// The requested convention, or the first available one of star, social-gan and simulated. Missing files are fetched,
/// to `data` if given.
pub(crate) fn choose(workspace: &Workspace, asked: Option<&str>, data: Option<&Path>) -> Result<Chosen> {
    let manifest = Manifest::load(workspace)?;
    let is_there = |name: &str| Ok::<_, anyhow::Error>(manifest.entry(name)?.locate(workspace, name, data).is_ok());
    if let (None, Some(folder)) = (asked, data) {
        // Nothing is fetched to a folder that was named explicitly, because its name may be mistyped.
        ensure!(
            is_there(RECORDED[0])? || is_there(RECORDED[1])?,
            "{} holds no recordings: correct --data, or name the convention to fetch with --convention",
            folder.display()
        );
    }
    // The report shows baselines of the other convention if its recordings are present, so these must not be wrong.
    for convention in RECORDED.into_iter().filter(|_| asked != Some(SIMULATED)) {
        let entry = manifest.entry(convention)?;
        if let Ok(folder) = entry.locate(workspace, convention, data) {
            entry.check(&folder)?;
        }
    }
    let mut reasons = Vec::new();
    let conventions = asked.map_or_else(|| RECORDED.to_vec(), |name| vec![name]);
    for convention in conventions.into_iter().filter(|name| *name != SIMULATED) {
        match manifest.entry(convention)?.obtain(workspace, convention, data) {
            Ok((folder, reason)) => {
                reasons.push(reason);
                return Ok(Chosen {
                    convention: convention.to_owned(),
                    folder: Some(folder),
                    reason: reasons.join("; "),
                });
            }
            Err(error) if asked.is_some() => return Err(error),
            Err(error) => reasons.push(format!("{error:#}")),
        }
    }
    reasons.push("the simulated crowd needs no files".to_owned());
    Ok(Chosen {
        convention: SIMULATED.to_owned(),
        folder: None,
        reason: reasons.join("; "),
    })
}

#[cfg(test)]
mod tests;
