//! Where recordings lie on this machine.

use std::env;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use super::manifest::Entry;
use super::{Convention, FETCHED};
use crate::workspace::{Workspace, absolute};

/// Variable that names a folder of recordings.
pub(crate) const VARIABLE: &str = "DDL_DATASETS";

/// The folders that are looked into, in order, each with what it is called in a message.
#[derive(Debug, Clone)]
pub(crate) struct Places(Vec<(String, PathBuf)>);

impl Places {
    /// An explicit folder alone; otherwise the variable's, then the workspace's own.
    ///
    /// Somebody who names a folder wants that one: nothing else stands in for it.
    pub(crate) fn new(workspace: &Workspace, explicit: Option<&Path>) -> Result<Self> {
        if let Some(folder) = explicit {
            return Ok(Self(vec![("--data".to_owned(), absolute(folder)?)]));
        }
        let mut places = Vec::new();
        if let Some(folder) = env::var_os(VARIABLE).filter(|value| !value.is_empty()) {
            places.push((format!("${VARIABLE}"), absolute(Path::new(&folder))?));
        }
        places.push((FETCHED.to_owned(), workspace.path(FETCHED)));
        Ok(Self(places))
    }

    /// The places as a phrase, for a message that nothing was found.
    pub(crate) fn list(&self) -> String {
        let named = |(name, folder): &(String, PathBuf)| {
            if name == FETCHED {
                name.clone()
            } else {
                format!("{name} ({})", folder.display())
            }
        };
        self.0.iter().map(named).collect::<Vec<_>>().join(", ")
    }
}

/// The first folder that holds every file of a convention: a place itself, or its sub-folder
/// named after the convention. Contents are not looked at.
pub(crate) fn lookup(places: &Places, convention: Convention, entry: &Entry) -> Option<PathBuf> {
    let holds = |folder: &PathBuf| {
        entry
            .files
            .iter()
            .all(|file| folder.join(&file.name).is_file())
    };
    places
        .0
        .iter()
        .flat_map(|(_, folder)| [folder.clone(), folder.join(convention.name())])
        .find(holds)
}

/// Hashes every file of a convention in a folder; the error names every wrong file.
pub(crate) fn check(folder: &Path, entry: &Entry) -> Result<()> {
    let mut complaints = Vec::new();
    for file in &entry.files {
        if let Err(error) = file.pin().check(&folder.join(&file.name)) {
            complaints.push(format!("{}: {}", file.name, error.root_cause()));
        }
    }
    if complaints.is_empty() {
        return Ok(());
    }
    bail!(
        "{} of {} files are wrong ({})",
        complaints.len(),
        entry.files.len(),
        complaints.join("; ")
    )
}

/// A folder whose files are all there and right, or none; files that are there and wrong are an
/// error, for nothing may stand in for them in silence.
pub(super) fn find_right(
    places: &Places,
    convention: Convention,
    entry: &Entry,
) -> Result<Option<PathBuf>> {
    let Some(folder) = lookup(places, convention, entry) else {
        return Ok(None);
    };
    check(&folder, entry).with_context(|| {
        format!(
            "{} does not hold the pinned {convention} recordings: delete the wrong files, then \
             `cargo xtask data fetch --convention {convention}`",
            folder.display()
        )
    })?;
    Ok(Some(folder))
}
