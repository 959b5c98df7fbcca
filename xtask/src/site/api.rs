//! The interface of every crate, rendered by rustdoc.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use serde_json::Value;

use crate::workspace::{Workspace, step};

#[derive(Debug, PartialEq, Eq)]
pub(super) struct Library {
    pub(super) package: String,
    /// Its name in code and in addresses of pages.
    pub(super) module: String,
    /// The name of its folder in `crates`.
    pub(super) folder: String,
    pub(super) description: String,
}

/// Every published library crate of the workspace, in the order of its manifest.
pub(super) fn libraries(metadata: &Value) -> Vec<Library> {
    let packages = metadata["packages"].as_array().into_iter().flatten();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let published = packages.filter(|package| package["publish"].is_null());
    published
        .filter_map(|package| {
            let targets = package["targets"].as_array()?;
            let of_kind = |kind: &str| {
                let is = |target: &&Value| {
                    let kinds = target["kind"].as_array();
                    kinds.is_some_and(|kinds| kinds.iter().any(|one| one == kind))
                };
                targets.iter().find(is)
            };
            // The library of a program serves only the program.
            if of_kind("bin").is_some() {
                return None;
            }
            Some(Library {
                package: text(&package["name"]),
                module: text(&of_kind("lib")?["name"]).replace('-', "_"),
                folder: text(&package["manifest_path"]).rsplit('/').nth(1)?.to_owned(),
                description: text(&package["description"]),
            })
        })
        .collect()
}

/// Runs rustdoc, for which every warning is an error (`[workspace.lints.rustdoc]`), and moves its pages from `made` to
/// `out`.
pub(super) fn build(workspace: &Workspace, libraries: &[Library], made: &Path, out: &Path) -> Result<()> {
    // Crates that no longer exist, and dependencies from other calls, would appear in every list and search.
    super::remove(made)?;
    // rustdoc links to an item of another crate only if that crate's folder exists. Cargo removes a crate's folder
    // before it runs rustdoc for it. With one job, no other crate is rendered meanwhile.
    for library in libraries {
        let folder = made.join(&library.module);
        fs::create_dir_all(&folder).with_context(|| format!("{} cannot be made", folder.display()))?;
    }
    // The complete interface, also on a machine without libtorch.
    let features = "ddl-cli/torch,ddl-cli/doc-only";
    let arguments = [
        "doc",
        "--jobs=1",
        "--workspace",
        "--no-deps",
        "--quiet",
        "--features",
        features,
    ];
    step("`cargo doc`", &workspace.cargo(arguments))?;
    fs::rename(made, out).with_context(|| format!("{} cannot be moved to {}", made.display(), out.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_crates_are_found_with_their_descriptions() {
        let found = libraries(&Workspace::find().unwrap().metadata().unwrap());
        let has = |name: &str| found.iter().any(|library| library.package == name);
        assert!(has("ddl-forecast") && has("ddl-softdtw"), "{found:?}");
        let front = found.iter().find(|library| library.module == "ddl");
        assert!(front.is_some_and(|library| library.folder == "ddl"));
        assert!(!["xtask", "ddl-tests", "ddl-cli"].into_iter().any(has), "{found:?}");
        assert!(found.iter().all(|library| !library.description.is_empty()));
    }
}
