//! Fetching of the recordings of one convention.

use std::fs;
use std::path::Path;

use anyhow::{Result, bail};
use ddl_data::Convention;

use super::manifest::{Entry, PinnedFile};
use super::source;
use crate::python::Python;

/// Puts every missing or wrong file of a convention into `folder`, from the first source of the manifest that has it.
/// Returns the source's name, or `None` if nothing was missing. `say` receives a message for each attempt.
pub(crate) fn fetch<'a>(
    convention: Convention,
    entry: &'a Entry,
    folder: &Path,
    say: &mut dyn FnMut(&str),
) -> Result<Option<&'a str>> {
    if missing(entry, folder).is_empty() {
        return Ok(None);
    }
    let python = Python::find()?;
    let mut reasons = Vec::new();
    for source in &entry.sources {
        say(&format!("{convention}: fetching from {}", source.name()));
        match source::get(&python, source, &missing(entry, folder), folder) {
            Ok(()) => return Ok(Some(source.name())),
            Err(error) => reasons.push(format!("{}: {error:#}", source.name())),
        }
    }
    // Only an empty folder can be removed: files that arrived before are right and stay.
    let _ = fs::remove_dir(folder);
    bail!(
        "the {convention} recordings cannot be fetched ({}); check the network, or copy them by \
         hand (docs/recordings.md)",
        reasons.join("; ")
    )
}

pub(crate) fn check(folder: &Path, entry: &Entry) -> Result<()> {
    let complaint = |file: &PinnedFile| {
        let error = file.pin().check(&folder.join(&file.name)).err()?;
        Some(format!("{}: {}", file.name, error.root_cause()))
    };
    let complaints: Vec<String> = entry.files.iter().filter_map(complaint).collect();
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

fn missing<'a>(entry: &'a Entry, folder: &Path) -> Vec<&'a PinnedFile> {
    let is_wrong = |file: &&PinnedFile| file.pin().check(&folder.join(&file.name)).is_err();
    entry.files.iter().filter(is_wrong).collect()
}

#[cfg(test)]
#[path = "fetch_tests.rs"]
mod tests;
