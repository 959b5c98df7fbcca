//! Which convention a command works on, and why.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use super::locate::find_right;
use super::{Convention, FETCHED, Manifest, Places, fetch};
use crate::workspace::{Workspace, absolute};

/// A convention that can be had.
#[derive(Debug, Clone)]
pub(crate) struct Chosen {
    pub(crate) convention: Convention,
    /// Folder of its recordings; none for the simulated one.
    pub(crate) folder: Option<PathBuf>,
    /// Why this one: a clause.
    pub(crate) reason: String,
}

/// The convention asked for, or the first of star, social-gan and simulated that can be had.
///
/// What is missing is fetched. An explicit folder is where recordings are looked for and put.
///
/// # Errors
/// If the convention asked for cannot be had, or if recordings that are there are not the pinned
/// ones.
pub(crate) fn choose(
    workspace: &Workspace,
    asked: Option<Convention>,
    data: Option<&Path>,
    say: &mut dyn FnMut(&str),
) -> Result<Chosen> {
    let manifest = Manifest::load(workspace)?;
    let places = Places::new(workspace, data)?;
    if let Some(convention) = asked {
        let (folder, found) = obtain(workspace, &manifest, &places, convention, data, say)?;
        return Ok(Chosen {
            convention,
            folder,
            reason: format!("as asked for; {found}"),
        });
    }
    if let Some(folder) = data {
        // A folder that was named is meant: nothing is fetched into a mistyped one.
        let mut found = false;
        for convention in Convention::RECORDED {
            if let Some(entry) = manifest.entry(convention) {
                found |= find_right(&places, convention, entry)?.is_some();
            }
        }
        ensure!(
            found,
            "{} holds no recordings: correct --data, or say with --convention what to fetch there",
            folder.display()
        );
    }
    first_that_can_be_had(workspace, &manifest, &places, data, say)
}

/// The folder of a convention's recordings if they are on this machine: in the usual places, or beside the recordings of
/// another convention. Nothing is fetched.
///
/// # Errors
/// If recordings are there that are not the pinned ones.
pub(crate) fn at_hand(
    workspace: &Workspace,
    convention: Convention,
    another: Option<&Path>,
) -> Result<Option<PathBuf>> {
    let manifest = Manifest::load(workspace)?;
    let Some(entry) = manifest.entry(convention) else {
        return Ok(None);
    };
    let beside = another.and_then(Path::parent);
    for folder in [None, beside] {
        let places = Places::new(workspace, folder)?;
        if let Some(found) = find_right(&places, convention, entry)? {
            return Ok(Some(found));
        }
    }
    Ok(None)
}

/// The recorded conventions in turn, then the simulated crowd.
fn first_that_can_be_had(
    workspace: &Workspace,
    manifest: &Manifest,
    places: &Places,
    data: Option<&Path>,
    say: &mut dyn FnMut(&str),
) -> Result<Chosen> {
    let mut reasons = Vec::new();
    for convention in Convention::RECORDED {
        if let Some(entry) = manifest.entry(convention) {
            // Recordings that are there and not the pinned ones are an error, not a reason to go on.
            find_right(places, convention, entry)?;
        }
        match obtain(workspace, manifest, places, convention, data, say) {
            Ok((folder, found)) => {
                reasons.push(found);
                let reason = reasons.join("; ");
                return Ok(Chosen {
                    convention,
                    folder,
                    reason,
                });
            }
            Err(error) => reasons.push(format!("{error:#}")),
        }
    }
    reasons.push("the simulated crowd needs no files".to_owned());
    Ok(Chosen {
        convention: Convention::Simulated,
        folder: None,
        reason: reasons.join("; "),
    })
}

/// The folder of a convention's recordings, found or fetched, and a clause that says which.
fn obtain(
    workspace: &Workspace,
    manifest: &Manifest,
    places: &Places,
    convention: Convention,
    data: Option<&Path>,
    say: &mut dyn FnMut(&str),
) -> Result<(Option<PathBuf>, String)> {
    let Some(entry) = manifest.entry(convention) else {
        return Ok((None, "it needs no files".to_owned()));
    };
    let count = entry.files.len();
    if let Some(folder) = find_right(places, convention, entry)? {
        let found = format!(
            "its {count} files are in {}, hashes right",
            folder.display()
        );
        return Ok((Some(folder), found));
    }
    let folder = data
        .map_or_else(|| Ok(workspace.path(FETCHED)), absolute)?
        .join(convention.name());
    let source = fetch(convention, entry, &folder, say)
        .with_context(|| format!("{convention} is not in {}", places.list()))?
        .unwrap_or("an earlier run");
    let found = format!(
        "its {count} files are in {}, from {source}",
        folder.display()
    );
    Ok((Some(folder), found))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// A workspace whose manifest names sources that nobody can reach.
    fn workspace() -> (tempfile::TempDir, Workspace) {
        let folder = tempfile::tempdir().unwrap();
        let real = Workspace::find().unwrap();
        let text = fs::read_to_string(real.path("datasets/manifest.toml")).unwrap();
        let text = text
            .lines()
            .map(|line| {
                if line.starts_with("address = ") {
                    "address = \"file:///nowhere/{path}\""
                } else if line.starts_with("package = ") {
                    "package = \"..//no such package\""
                } else {
                    line
                }
            })
            .collect::<Vec<_>>()
            .join("\n");
        fs::create_dir_all(folder.path().join("datasets")).unwrap();
        fs::write(folder.path().join("datasets/manifest.toml"), text).unwrap();
        let workspace = Workspace::at(folder.path()).unwrap();
        (folder, workspace)
    }

    #[test]
    fn without_recordings_and_network_the_crowd_is_simulated_and_says_why() {
        let (folder, workspace) = workspace();
        let data = folder.path().join("empty");
        let manifest = Manifest::load(&workspace).unwrap();
        let places = Places::new(&workspace, Some(&data)).unwrap();
        let chosen =
            first_that_can_be_had(&workspace, &manifest, &places, Some(&data), &mut |_| {})
                .unwrap();
        assert_eq!(chosen.convention, Convention::Simulated);
        assert_eq!(chosen.folder, None);
        for word in ["star is not in", "social-gan is not in", "simulated"] {
            assert!(chosen.reason.contains(word), "{}", chosen.reason);
        }
        let error = choose(&workspace, Some(Convention::Star), Some(&data), &mut |_| {});
        assert!(format!("{:#}", error.unwrap_err()).contains("cannot be fetched"));
        // a folder that was named and holds nothing is a mistake, not a reason to simulate
        let error = choose(&workspace, None, Some(&data), &mut |_| {}).unwrap_err();
        assert!(format!("{error:#}").contains("correct --data"), "{error:#}");
    }

    #[test]
    fn files_that_are_there_but_wrong_are_never_used_nor_replaced_in_silence() {
        let (folder, workspace) = workspace();
        let manifest = Manifest::load(&workspace).unwrap();
        let data = folder.path().join("data");
        fs::create_dir(&data).unwrap();
        for file in &manifest.entry(Convention::Star).unwrap().files {
            fs::write(data.join(&file.name), "1,2\n1,1\n0,0\n0,0\n").unwrap();
        }
        let error = choose(&workspace, Some(Convention::Star), Some(&data), &mut |_| {});
        let message = format!("{:#}", error.unwrap_err());
        assert!(message.contains("8 of 8 files are wrong"), "{message}");
        let error = choose(&workspace, None, Some(&data), &mut |_| {});
        let message = format!("{:#}", error.unwrap_err());
        assert!(message.contains("8 of 8 files are wrong"), "{message}");
    }

    #[test]
    fn another_convention_is_found_beside_the_one_at_hand_and_never_fetched() {
        let (folder, workspace) = workspace();
        let star = folder.path().join("data/star");
        let found = || at_hand(&workspace, Convention::SocialGan, Some(&star));
        fs::create_dir_all(&star).unwrap();
        assert_eq!(found().unwrap(), None);
        let manifest = Manifest::load(&workspace).unwrap();
        let beside = folder.path().join("data/social-gan");
        fs::create_dir(&beside).unwrap();
        for file in &manifest.entry(Convention::SocialGan).unwrap().files {
            fs::write(beside.join(&file.name), "0\t1\t0\t0\n").unwrap();
        }
        let message = format!("{:#}", found().unwrap_err());
        assert!(message.contains("8 of 8 files are wrong"), "{message}");
        let none = at_hand(&workspace, Convention::Simulated, Some(&star));
        assert_eq!(none.unwrap(), None);
    }

    #[test]
    fn the_simulated_convention_is_had_at_once() {
        let (_folder, workspace) = workspace();
        let chosen = choose(&workspace, Some(Convention::Simulated), None, &mut |_| {}).unwrap();
        assert_eq!(
            (chosen.convention, chosen.folder),
            (Convention::Simulated, None)
        );
    }
}
