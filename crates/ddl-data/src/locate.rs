//! Search for the folder of the recordings.

use std::path::{Path, PathBuf};

use crate::convention::Convention;
use crate::file_error::DataError;

/// Environment variable that names the folder of the recordings.
const DATASETS_VARIABLE: &str = "DDL_DATASETS";

/// Default folder of the recordings, below the root of the workspace.
const DEFAULT_FOLDER: &str = "datasets/eth_ucy";

/// Finds the folder with a convention's files.
///
/// The search uses `explicit` if given, else the folder named by `$DDL_DATASETS` if set, else `datasets/eth_ucy`. The
/// last two, where relative, are tried from the current directory and from each one above it, up to the first with a
/// `Cargo.lock`. The files may lie in the folder itself, in its sub-folder named after the convention, or in such a
/// folder beside it.
///
/// # Errors
/// [`DataError::NotFound`] names every folder tried and the first file missing in it; [`DataError::NoFiles`] for
/// conventions without files of fixed names.
pub fn locate(convention: Convention, explicit: Option<&Path>) -> Result<PathBuf, DataError> {
    let variable = std::env::var_os(DATASETS_VARIABLE).filter(|v| !v.is_empty()).map(PathBuf::from);
    let here = std::env::current_dir().unwrap_or_default();
    locate_among(convention, roots(explicit, variable.as_deref(), &here))
}

fn roots(explicit: Option<&Path>, variable: Option<&Path>, here: &Path) -> Vec<PathBuf> {
    if let Some(only) = explicit {
        return vec![only.to_owned()];
    }
    let wanted = variable.unwrap_or(Path::new(DEFAULT_FOLDER));
    if wanted.is_absolute() {
        return vec![wanted.to_owned()];
    }
    let mut roots = Vec::new();
    for directory in here.ancestors() {
        roots.push(directory.join(wanted));
        if directory.join("Cargo.lock").is_file() {
            break;
        }
    }
    roots
}

fn locate_among(convention: Convention, roots: Vec<PathBuf>) -> Result<PathBuf, DataError> {
    if convention.format().is_none() {
        return Err(DataError::NoFiles(convention.name()));
    }
    let mut searched = Vec::new();
    for root in roots {
        let mut candidates = vec![root.join(convention.name())];
        if Convention::ALL.iter().any(|c| root.ends_with(c.name())) {
            candidates.extend(root.parent().map(|parent| parent.join(convention.name())));
        }
        candidates.insert(0, root);
        for folder in candidates {
            match convention.file_names().find(|file| !folder.join(file).is_file()) {
                None => return Ok(folder),
                Some(missing) => searched.push(format!("{} (no {missing})", folder.display())),
            }
        }
    }
    Err(DataError::NotFound { convention: convention.name(), searched, variable: DATASETS_VARIABLE })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fill(folder: &Path, convention: Convention) {
        std::fs::create_dir_all(folder).unwrap();
        for file in convention.file_names() {
            std::fs::write(folder.join(file), "").unwrap();
        }
    }

    #[test]
    fn files_are_found_in_the_folder_below_it_and_beside_it() {
        let root = tempfile::tempdir().unwrap();
        let [star, social_gan] = [Convention::Star, Convention::SocialGan].map(|convention| {
            let folder = root.path().join(convention.name());
            fill(&folder, convention);
            folder
        });
        for start in [root.path(), &star, &social_gan] {
            assert_eq!(locate(Convention::Star, Some(start)).unwrap(), star);
            assert_eq!(locate(Convention::SocialGan, Some(start)).unwrap(), social_gan);
        }
    }

    #[test]
    fn relative_folders_are_looked_for_up_to_the_root_of_the_workspace() {
        let folder = tempfile::tempdir().unwrap();
        let workspace = folder.path().join("workspace");
        let member = workspace.join("crates/member");
        std::fs::create_dir_all(&member).unwrap();
        std::fs::write(workspace.join("Cargo.lock"), "").unwrap();
        let folders = roots(None, None, &member);
        assert_eq!(folders.len(), 3, "the folders above the workspace are not searched");
        assert_eq!(folders[2], workspace.join(DEFAULT_FOLDER));
        let relative = roots(None, Some(Path::new("../data")), &member);
        assert_eq!(relative[2], workspace.join("../data"));
        assert_eq!(roots(None, Some(Path::new("/data")), &member), [PathBuf::from("/data")]);
        assert_eq!(roots(Some(Path::new("mine")), Some(Path::new("/data")), &member), [PathBuf::from("mine")]);
    }
}
