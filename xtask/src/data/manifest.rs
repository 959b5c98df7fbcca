//! `datasets/manifest.toml`: every file of each recorded convention, pinned.

use std::collections::BTreeMap;
use std::fs;

use anyhow::{Context, Result, bail, ensure};
use ddl_data::Convention;
use serde::Deserialize;

use super::RECORDED;
use crate::digest::Pin;
use crate::workspace::Workspace;

const FILE: &str = "datasets/manifest.toml";

/// The whole manifest.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Manifest {
    star: Entry,
    #[serde(rename = "social-gan")]
    social_gan: Entry,
    citation: BTreeMap<String, String>,
}

/// One convention: its files, and where to get them.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Entry {
    pub(crate) description: String,
    pub(crate) terms: String,
    /// Keys of the manifest's citations.
    pub(crate) cite: Vec<String>,
    /// Tried in order until one gives every file.
    #[serde(rename = "source")]
    pub(crate) sources: Vec<Source>,
    #[serde(rename = "file")]
    pub(crate) files: Vec<PinnedFile>,
}

/// A file, pinned to the byte.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PinnedFile {
    /// Its name in a folder of recordings.
    pub(crate) name: String,
    /// What stands for `{path}` in a source.
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

/// Where files come from.
#[derive(Debug, Clone, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Source {
    /// Each file at an address of its own.
    Address { name: String, address: String },
    /// All files in one archive on the package index.
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
        let text = fs::read_to_string(workspace.path(FILE))
            .with_context(|| format!("{FILE} cannot be read"))?;
        Self::parse(&text).with_context(|| format!("{FILE} is not well formed"))
    }

    pub(crate) fn parse(text: &str) -> Result<Self> {
        let manifest: Self = toml::from_str(text)?;
        for convention in RECORDED {
            manifest
                .check(manifest.entry(convention)?)
                .with_context(|| format!("in the convention {convention}"))?;
        }
        Ok(manifest)
    }

    /// The entry of a convention; there is none of those without pinned files.
    pub(crate) fn entry(&self, convention: Convention) -> Result<&Entry> {
        match convention {
            Convention::Star => Ok(&self.star),
            Convention::SocialGan => Ok(&self.social_gan),
            Convention::Simulated | Convention::Own => {
                bail!("no file of the {convention} convention is pinned")
            }
        }
    }

    /// What to cite when numbers of a convention are published.
    pub(crate) fn citations<'a>(&'a self, entry: &'a Entry) -> impl Iterator<Item = &'a str> {
        entry
            .cite
            .iter()
            .filter_map(|key| self.citation.get(key).map(String::as_str))
    }

    fn check(&self, entry: &Entry) -> Result<()> {
        ensure!(!entry.files.is_empty(), "there is no file");
        for file in &entry.files {
            let name = &file.name;
            ensure!(
                !name.is_empty() && !name.starts_with('.') && !name.contains(['/', '\\']),
                "{name:?} is not a plain file name"
            );
            ensure!(
                is_sha256(&file.sha256),
                "{name}: sha256 is not 64 lower-case hex digits"
            );
        }
        for source in &entry.sources {
            let (pattern, hash) = match source {
                Source::Address { address, .. } => (address, None),
                Source::Package { member, sha256, .. } => (member, Some(sha256)),
            };
            ensure!(
                pattern.contains("{path}"),
                "{}: {{path}} is missing",
                source.name()
            );
            ensure!(
                hash.is_none_or(|hash| is_sha256(hash)),
                "{}: sha256 is not 64 lower-case hex digits",
                source.name()
            );
        }
        for key in &entry.cite {
            ensure!(
                self.citation.contains_key(key),
                "there is no citation {key}"
            );
        }
        Ok(())
    }
}

fn is_sha256(text: &str) -> bool {
    text.len() == 64
        && text
            .bytes()
            .all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text() -> String {
        fs::read_to_string(Workspace::find().unwrap().path(FILE)).unwrap()
    }

    #[test]
    fn the_manifest_pins_what_the_folds_use() {
        let manifest = Manifest::parse(&text()).unwrap();
        for convention in RECORDED {
            let entry = manifest.entry(convention).unwrap();
            let mut used: Vec<&str> = convention.file_names().collect();
            let mut pinned: Vec<&str> = entry.files.iter().map(|file| file.name.as_str()).collect();
            used.sort_unstable();
            pinned.sort_unstable();
            assert_eq!(used, pinned, "{convention}");
            assert_eq!(manifest.citations(entry).count(), 2);
        }
    }

    #[test]
    fn mistakes_are_refused_with_their_place() {
        for (from, to, complaint) in [
            (
                "name = \"eth.csv\"",
                "name = \"../eth.csv\"",
                "plain file name",
            ),
            ("bytes = 206437", "bytes = -1", "bytes"),
            ("sha256 = \"08e5", "sha256 = \"08E5", "sha256"),
            ("/{path}\"", "/\"", "{path} is missing"),
            ("kind = \"address\"", "kind = \"adress\"", "adress"),
            (
                "cite = [\"pellegrini2009\"",
                "cite = [\"nobody\"",
                "no citation nobody",
            ),
        ] {
            let text = text();
            assert!(text.contains(from), "{from}");
            let message = format!(
                "{:#}",
                Manifest::parse(&text.replacen(from, to, 1)).unwrap_err()
            );
            assert!(message.contains(complaint), "{message}");
        }
    }
}
