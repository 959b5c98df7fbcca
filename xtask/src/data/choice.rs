//! Choice of the data convention for a command.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use ddl_data::{Convention, locate};

use super::fetch::{check, fetch};
use super::{FETCHED, Manifest, RECORDED};
use crate::workspace::{Workspace, absolute};

#[derive(Debug, Clone)]
pub(crate) struct Chosen {
    pub(crate) convention: Convention,
    pub(crate) folder: Option<PathBuf>,
    /// The reason for this choice: a clause.
    pub(crate) reason: String,
}

/// The requested convention, or the first available one of star, social-gan and simulated. Missing files are fetched,
/// to `data` if given.
pub(crate) fn choose(
    workspace: &Workspace,
    asked: Option<Convention>,
    data: Option<&Path>,
    say: &mut dyn FnMut(&str),
) -> Result<Chosen> {
    if let Some(convention) = asked {
        let (folder, found) = obtain(workspace, convention, data, say)?;
        return Ok(Chosen {
            convention,
            folder,
            reason: format!("as requested; {found}"),
        });
    }
    if let Some(folder) = data {
        // Nothing is fetched to a folder that was named explicitly, because its name may be mistyped.
        let mut found = false;
        for convention in RECORDED {
            found |= find_right(workspace, convention, data)?.is_some();
        }
        ensure!(
            found,
            "{} holds no recordings: correct --data, or name the convention to fetch with --convention",
            folder.display()
        );
    }
    first_that_can_be_had(workspace, data, say)
}

/// Tries the recorded conventions in order, then the simulated crowd.
fn first_that_can_be_had(workspace: &Workspace, data: Option<&Path>, say: &mut dyn FnMut(&str)) -> Result<Chosen> {
    let mut reasons = Vec::new();
    for convention in RECORDED {
        // Recordings that differ from the pinned ones are an error, not a reason to try the next convention.
        find_right(workspace, convention, data)?;
        match obtain(workspace, convention, data, say) {
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

/// The folder of a convention's recordings, found or fetched, and a clause that describes it.
fn obtain(
    workspace: &Workspace,
    convention: Convention,
    data: Option<&Path>,
    say: &mut dyn FnMut(&str),
) -> Result<(Option<PathBuf>, String)> {
    match convention {
        Convention::Simulated => return Ok((None, "it needs no files".to_owned())),
        Convention::Own => {
            bail!("own recordings cannot be fetched: choose star, social-gan or simulated")
        }
        Convention::Star | Convention::SocialGan => {}
    }
    if let Some(folder) = find_right(workspace, convention, data)? {
        let found = format!("its files are in {}, hashes verified", folder.display());
        return Ok((Some(folder), found));
    }
    let absent = locate(convention, data).err();
    let absent = absent.map_or(String::new(), |error| error.to_string());
    let (folder, source) = fetch_to(workspace, convention, data, say).context(absent)?;
    let found = format!("its files are in {}, from {source}", folder.display());
    Ok((Some(folder), found))
}

/// The folder in which all files of a convention are present and right, or `None`. Wrong files are an error, because
/// nothing may replace them silently.
pub(crate) fn find_right(
    workspace: &Workspace,
    convention: Convention,
    data: Option<&Path>,
) -> Result<Option<PathBuf>> {
    let Ok(folder) = locate(convention, data) else {
        return Ok(None);
    };
    let manifest = Manifest::load(workspace)?;
    check(&folder, manifest.entry(convention)?).with_context(|| {
        format!(
            "{} does not hold the pinned {convention} recordings: delete the wrong files, then run \
             `cargo xtask data fetch --convention {convention}`",
            folder.display()
        )
    })?;
    absolute(&folder).map(Some)
}

/// Fetches the missing and wrong files of a convention. Returns the folder and the source.
pub(crate) fn fetch_to(
    workspace: &Workspace,
    convention: Convention,
    data: Option<&Path>,
    say: &mut dyn FnMut(&str),
) -> Result<(PathBuf, String)> {
    let manifest = Manifest::load(workspace)?;
    let folder = data
        .map_or_else(|| Ok(workspace.path(FETCHED)), absolute)?
        .join(convention.name());
    let source = fetch(convention, manifest.entry(convention)?, &folder, say)?;
    Ok((folder, source.unwrap_or("an earlier run").to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

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
    fn without_recordings_and_network_the_crowd_is_simulated_with_a_reason() {
        let (folder, workspace) = workspace();
        let data = folder.path().join("empty");
        let chosen = first_that_can_be_had(&workspace, Some(&data), &mut |_| {}).unwrap();
        assert_eq!(chosen.convention, Convention::Simulated);
        assert_eq!(chosen.folder, None);
        for word in ["the star recordings", "the social-gan recordings", "simulated"] {
            assert!(chosen.reason.contains(word), "{}", chosen.reason);
        }
        let error = choose(&workspace, Some(Convention::Star), Some(&data), &mut |_| {});
        assert!(format!("{:#}", error.unwrap_err()).contains("cannot be fetched"));
        let error = choose(&workspace, None, Some(&data), &mut |_| {}).unwrap_err();
        assert!(format!("{error:#}").contains("correct --data"), "{error:#}");
    }

    #[test]
    fn wrong_files_are_neither_used_nor_replaced_silently() {
        let (folder, workspace) = workspace();
        let manifest = Manifest::load(&workspace).unwrap();
        let data = folder.path().join("star");
        fs::create_dir(&data).unwrap();
        for file in &manifest.entry(Convention::Star).unwrap().files {
            fs::write(data.join(&file.name), "1,2\n1,1\n0,0\n0,0\n").unwrap();
        }
        // Also if they are in the folder beside the named one.
        let beside = folder.path().join("social-gan");
        fs::create_dir(&beside).unwrap();
        for (asked, place) in [
            (Some(Convention::Star), &data),
            (None, &data),
            (Some(Convention::Star), &beside),
        ] {
            let error = choose(&workspace, asked, Some(place), &mut |_| {}).unwrap_err();
            let message = format!("{error:#}");
            assert!(message.contains("8 of 8 files are wrong"), "{message}");
        }
    }
}
