//! `datasets/manifest.toml`: the pinned files of each recorded convention.

use std::collections::BTreeMap;
use std::fs;

use anyhow::{Context, Result, bail};
use ddl_data::Convention;
use serde::Deserialize;

use crate::digest::Pin;
use crate::workspace::Workspace;

const FILE: &str = "datasets/manifest.toml";

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Manifest {
    star: Entry,
    #[serde(rename = "social-gan")]
    social_gan: Entry,
    citation: BTreeMap<String, String>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Entry {
    pub(crate) description: String,
    pub(crate) terms: String,
    /// Keys of the manifest's citations.
    pub(crate) cite: Vec<String>,
    /// Tried in order until one has every file.
    #[serde(rename = "source")]
    pub(crate) sources: Vec<Source>,
    #[serde(rename = "file")]
    pub(crate) files: Vec<PinnedFile>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PinnedFile {
    /// Its name in a folder of recordings.
    pub(crate) name: String,
    /// Replaces `{path}` in the address of a source.
    pub(crate) path: String,
    pub(crate) bytes: u64,
    pub(crate) sha256: String,
}

impl PinnedFile {
    pub(crate) fn pin(&self) -> Pin<'_> {
        Pin {
            sha256: &self.sha256,
            bytes: self.bytes,
        }
    }
}

#[derive(Debug, Clone, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Source {
    Address {
        name: String,
        address: String,
    },
    Package {
        name: String,
        package: String,
        archive: String,
        bytes: u64,
        sha256: String,
        member: String,
    },
}

impl Source {
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Address { name, .. } | Self::Package { name, .. } => name,
        }
    }
}

impl Manifest {
    pub(crate) fn load(workspace: &Workspace) -> Result<Self> {
        let text = fs::read_to_string(workspace.path(FILE)).with_context(|| format!("{FILE} cannot be read"))?;
        toml::from_str(&text).with_context(|| format!("{FILE} is not well formed"))
    }

    /// The entry of a convention with pinned files.
    pub(crate) fn entry(&self, convention: Convention) -> Result<&Entry> {
        match convention {
            Convention::Star => Ok(&self.star),
            Convention::SocialGan => Ok(&self.social_gan),
            Convention::Simulated | Convention::Own => {
                bail!("the {convention} convention has no pinned files")
            }
        }
    }

    pub(crate) fn citations<'a>(&'a self, entry: &'a Entry) -> impl Iterator<Item = &'a str> {
        entry
            .cite
            .iter()
            .filter_map(|key| self.citation.get(key).map(String::as_str))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::RECORDED;

    #[test]
    fn the_manifest_pins_the_files_of_the_folds() {
        let manifest = Manifest::load(&Workspace::find().unwrap()).unwrap();
        for convention in RECORDED {
            let entry = manifest.entry(convention).unwrap();
            let mut used: Vec<&str> = convention.file_names().collect();
            let mut pinned: Vec<&str> = entry.files.iter().map(|file| file.name.as_str()).collect();
            used.sort_unstable();
            pinned.sort_unstable();
            assert_eq!(used, pinned, "{convention}");
            assert_eq!(manifest.citations(entry).count(), 2);
            assert!(entry.files.iter().all(|file| file.sha256.len() == 64));
        }
    }
}
