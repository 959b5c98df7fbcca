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
    pub(super) description: String,
}

/// Every published library crate of the workspace, in the order of its manifest.
pub(super) fn libraries(metadata: &Value) -> Vec<Library> {
    let packages = metadata["packages"].as_array().into_iter().flatten();
    let published = packages.filter(|package| {
        let targets = package["targets"].as_array().into_iter().flatten();
        let kinds: Vec<&Value> = targets
            .flat_map(|target| target["kind"].as_array().into_iter().flatten())
            .collect();
        // The library of a program is internal to the program.
        let has = |name: &str| kinds.iter().any(|kind| **kind == name);
        package["publish"].is_null() && has("lib") && !has("bin")
    });
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    published
        .map(|package| Library {
            package: text(&package["name"]),
            module: text(&package["name"]).replace('-', "_"),
            description: text(&package["description"]),
        })
        .collect()
}

/// Runs rustdoc, for which every warning is an error (`[workspace.lints.rustdoc]`), and moves its pages from `made` to
/// `out`.
pub(super) fn build(
    workspace: &Workspace,
    libraries: &[Library],
    made: &Path,
    out: &Path,
) -> Result<()> {
    // Crates that no longer exist, and dependencies from other calls, would appear in every list and search.
    super::remove(made)?;
    // rustdoc links to an item of another crate only if that crate's folder exists. Cargo removes a crate's folder
    // before it runs rustdoc for it. With one job, no other crate is rendered meanwhile.
    for library in libraries {
        let folder = made.join(&library.module);
        fs::create_dir_all(&folder)
            .with_context(|| format!("{} cannot be made", folder.display()))?;
    }
    // The whole interface, on a machine without libtorch.
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
    fs::rename(made, out)
        .with_context(|| format!("{} cannot be moved to {}", made.display(), out.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_crates_are_found_with_their_descriptions() {
        let found = libraries(&Workspace::find().unwrap().metadata().unwrap());
        let has = |name: &str| found.iter().any(|library| library.package == name);
        assert!(has("ddl") && has("ddl-softdtw"), "{found:?}");
        assert!(
            !["xtask", "ddl-tests", "ddl-cli"].into_iter().any(has),
            "{found:?}"
        );
        assert!(found.iter().all(|library| !library.description.is_empty()));
    }
}
