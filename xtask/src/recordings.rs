//! Recordings: the pinned files of `datasets/manifest.toml`, found or fetched.

use crate::cache::sha256;
use crate::process::read;
use crate::python::Python;
use crate::workspace::{FETCHED, Workspace, absolute};
use anyhow::{Context, Result, bail, ensure};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

const MANIFEST: &str = "datasets/manifest.toml";
/// The conventions with files, in order of preference.
pub(crate) const RECORDED: [&str; 2] = ["star", "social-gan"];
/// The convention that needs no files.
pub(crate) const SIMULATED: &str = "simulated";
const FETCH: &str = include_str!("python/fetch.py");

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Manifest {
    star: ConventionFiles,
    #[serde(rename = "social-gan")]
    social_gan: ConventionFiles,
    pub(crate) citation: BTreeMap<String, String>,
}

/// The recordings of one convention.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ConventionFiles {
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

impl Manifest {
    pub(crate) fn load(workspace: &Workspace) -> Result<Self> {
        let text = fs::read_to_string(workspace.path(MANIFEST)).with_context(|| MANIFEST.to_owned())?;
        toml::from_str(&text).with_context(|| format!("{MANIFEST} is not well formed"))
    }

    pub(crate) fn entry(&self, convention: &str) -> Result<&ConventionFiles> {
        match convention {
            "star" => Ok(&self.star),
            "social-gan" => Ok(&self.social_gan),
            _ => bail!("no recordings of {convention:?} can be fetched: name one of {}", RECORDED.join(", ")),
        }
    }
}

impl ConventionFiles {
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

    /// The folder of the recordings, found or fetched, with hashes verified. Wrong files are an error: nothing may
    /// replace them silently. Nothing is fetched to a folder that is named without a convention: it may be mistyped.
    pub(crate) fn obtain(
        &self,
        workspace: &Workspace,
        convention: &str,
        asked: Option<&str>,
        data: Option<&Path>,
    ) -> Result<PathBuf> {
        let located = self.locate(workspace, convention, data);
        if located.is_ok() || data.is_some() && asked != Some(convention) {
            let folder = located.context("correct --data, or name the convention to fetch with --convention")?;
            self.check(&folder)?;
            return Ok(folder);
        }
        let folder = data.map_or_else(|| Ok(workspace.path(FETCHED)), absolute)?.join(convention);
        let source = self.fetch(convention, &folder)?;
        eprintln!("{convention}: fetched from {source}");
        Ok(folder)
    }

    /// Puts every missing or wrong file into `folder`, from the first source of the manifest that has it. Returns the
    /// source's name. Files that arrived before a failure are right and stay.
    fn fetch(&self, convention: &str, folder: &Path) -> Result<String> {
        fs::create_dir_all(folder).with_context(|| format!("{} cannot be made", folder.display()))?;
        let request = serde_json::json!({ "sources": self.source, "files": self.files, "folder": folder });
        let source = read(&mut Python::find()?.call(["-c", FETCH, &request.to_string()]));
        if source.is_err() {
            // Only an empty folder can be removed.
            fs::remove_dir(folder).ok();
        }
        let source = source.with_context(|| {
            format!(
                "the {convention} recordings cannot be fetched; check the network, or copy them by hand \
                 (docs/recordings.md)"
            )
        })?;
        self.check(folder)?;
        Ok(source.trim().to_owned())
    }
}

/// Finds or fetches the recordings of every convention before a command that may use them. What cannot be fetched is
/// told: the program takes the first convention that is there, and tests say what they lack.
pub(crate) fn bring_in(workspace: &Workspace) -> Result<()> {
    bring_in_for(workspace, None, None)
}

/// The same for `ddl benchmark`, with its options.
pub(crate) fn bring_in_for(workspace: &Workspace, asked: Option<&str>, data: Option<&Path>) -> Result<()> {
    if asked.is_some_and(|asked| !RECORDED.contains(&asked)) {
        return Ok(());
    }
    let manifest = Manifest::load(workspace)?;
    for convention in RECORDED {
        let entry = manifest.entry(convention)?;
        if asked.is_some_and(|asked| asked != convention) {
            continue;
        }
        if let Ok(folder) = entry.locate(workspace, convention, data) {
            entry.check(&folder)?;
        }
        match entry.obtain(workspace, convention, asked, data) {
            Ok(folder) => eprintln!("{convention}: its files are in {}, hashes verified", folder.display()),
            Err(error) if asked.is_some() => return Err(error),
            Err(error) => eprintln!("{convention}: {error:#}"),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
