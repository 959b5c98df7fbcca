//! The interface of every crate, as rustdoc shows it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use super::check::list;
use super::html;
use crate::whole_file;
use crate::workspace::{Workspace, step};

/// A crate that others can depend on.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Library {
    pub(super) package: String,
    pub(super) description: String,
}

impl Library {
    /// Its name in code and in addresses of pages.
    pub(super) fn module(&self) -> String {
        self.package.replace('-', "_")
    }
}

/// Every published library crate of the workspace, in the order of its manifest.
pub(super) fn libraries(workspace: &Workspace) -> Result<Vec<Library>> {
    let metadata = workspace.metadata()?;
    let packages = metadata["packages"].as_array().context("no packages")?;
    let published = packages.iter().filter(|package| {
        let targets = package["targets"].as_array().into_iter().flatten();
        let mut kinds = targets.flat_map(|target| target["kind"].as_array().into_iter().flatten());
        package["publish"].is_null() && kinds.any(|kind| kind == "lib")
    });
    let named = |package: &serde_json::Value, field: &str| {
        package[field].as_str().unwrap_or_default().to_owned()
    };
    Ok(published
        .map(|package| Library {
            package: named(package, "name"),
            description: named(package, "description"),
        })
        .collect())
}

/// Runs rustdoc, exactly as the check of the documentation in `ci`, and copies the pages to `out`.
pub(super) fn build(workspace: &Workspace, out: &Path) -> Result<()> {
    let document = || {
        make_room(workspace)?;
        let arguments = [
            "doc",
            "--workspace",
            "--features",
            "ddl-cli/torch",
            "--no-deps",
            "--quiet",
        ];
        step("`cargo doc`", &workspace.cargo(arguments))
    };
    document()?;
    let made = workspace.path("target/doc");
    let ours = our_pages(workspace)?;
    // A crate that is gone, or dependencies from another call, would be in every list and search.
    if !strangers(&made, &ours)?.is_empty() || !unresolved(&made)?.is_empty() {
        step(
            "`cargo clean --doc`",
            &workspace.cargo(["clean", "--doc", "--quiet"]),
        )?;
        document()?;
    }
    if let Some(stranger) = strangers(&made, &ours)?.first() {
        bail!(
            "{}: cargo documents {stranger}, which is no crate of this workspace",
            made.display()
        );
    }
    if let Some(page) = unresolved(&made)?.first() {
        bail!("{page}: rustdoc did not find what a link names");
    }
    copy(&made, out)
}

/// Makes the folder of each library's pages before rustdoc runs.
///
/// rustdoc links to another crate's item only if that crate's folder is there, and cargo documents crates side by side: on an
/// empty machine links would be left as `ddl_dynamics::StableEuler` now and then.
pub(crate) fn make_room(workspace: &Workspace) -> Result<()> {
    for library in libraries(workspace)? {
        let folder = workspace.path("target/doc").join(library.module());
        fs::create_dir_all(&folder)
            .with_context(|| format!("{} cannot be made", folder.display()))?;
    }
    Ok(())
}

/// Pages with a link that is still the path of an item.
fn unresolved(made: &Path) -> Result<Vec<String>> {
    let mut files = Vec::new();
    list(made, &mut files)?;
    let mut found = Vec::new();
    for file in files.iter().filter(|file| {
        file.extension()
            .is_some_and(|extension| extension == "html")
    }) {
        let text = fs::read_to_string(file)
            .with_context(|| format!("{} cannot be read", file.display()))?;
        let is_path = |target: &str| target.contains("::") && !target.contains(['/', '#']);
        if html::read(&text)
            .references
            .iter()
            .any(|reference| is_path(&reference.target))
        {
            found.push(file.display().to_string());
        }
    }
    found.sort();
    Ok(found)
}

/// Leads links of copied pages to files of `docs/` on to the pages of the guide, `shown` by the file's name.
pub(super) fn lead_to_guide(
    out: &Path,
    libraries: &[Library],
    shown: &BTreeMap<PathBuf, String>,
) -> Result<()> {
    for library in libraries {
        let page = out.join(library.module()).join("index.html");
        let mut text = fs::read_to_string(&page)
            .with_context(|| format!("{} cannot be read", page.display()))?;
        for (file, name) in shown {
            let name = name.trim_end_matches(".md");
            let from = format!("href=\"../../{}", file.display());
            text = text.replace(&from, &format!("href=\"../../guide/{name}.html"));
        }
        whole_file::write(&page, text.as_bytes())?;
    }
    Ok(())
}

/// Names under which crates of this workspace have their pages.
fn our_pages(workspace: &Workspace) -> Result<BTreeSet<String>> {
    let metadata = workspace.metadata()?;
    let packages = metadata["packages"].as_array().into_iter().flatten();
    let targets = packages.flat_map(|package| package["targets"].as_array().into_iter().flatten());
    Ok(targets
        .filter_map(|target| target["name"].as_str())
        .map(|name| name.replace('-', "_"))
        .collect())
}

/// Crates with pages in `made` that are none of ours.
fn strangers(made: &Path, ours: &BTreeSet<String>) -> Result<Vec<String>> {
    let mut found = Vec::new();
    let entries =
        fs::read_dir(made).with_context(|| format!("{} cannot be read", made.display()))?;
    for entry in entries {
        let entry = entry.with_context(|| format!("{} cannot be read", made.display()))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().join("index.html").is_file() && name != "src" && !ours.contains(&name) {
            found.push(name);
        }
    }
    found.sort();
    Ok(found)
}

/// Copies a folder with everything in it, but for hidden files.
pub(super) fn copy(from: &Path, to: &Path) -> Result<()> {
    let failed = || format!("{} cannot be copied to {}", from.display(), to.display());
    fs::create_dir_all(to).with_context(failed)?;
    for entry in fs::read_dir(from).with_context(failed)? {
        let entry = entry.with_context(failed)?;
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        let target = to.join(entry.file_name());
        if entry.file_type().with_context(failed)?.is_dir() {
            copy(&entry.path(), &target)?;
        } else {
            fs::copy(entry.path(), &target).with_context(failed)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_crates_are_found_with_what_they_say_of_themselves() {
        let found = libraries(&Workspace::find().unwrap()).unwrap();
        let names: Vec<&str> = found
            .iter()
            .map(|library| library.package.as_str())
            .collect();
        assert!(
            names.contains(&"ddl") && names.contains(&"ddl-softdtw"),
            "{names:?}"
        );
        for other in ["xtask", "ddl-tests", "ddl-cli"] {
            assert!(!names.contains(&other), "{other}");
        }
        assert!(found.iter().all(|library| !library.description.is_empty()));
    }

    #[test]
    fn pages_of_other_crates_are_noticed() {
        let made = tempfile::tempdir().unwrap();
        for name in ["ddl", "serde", "src", "static.files"] {
            fs::create_dir_all(made.path().join(name)).unwrap();
        }
        for name in ["ddl", "serde", "src"] {
            fs::write(made.path().join(name).join("index.html"), "").unwrap();
        }
        let ours = BTreeSet::from(["ddl".to_owned()]);
        assert_eq!(strangers(made.path(), &ours).unwrap(), ["serde"]);
    }

    #[test]
    fn links_that_rustdoc_left_are_noticed() {
        let made = tempfile::tempdir().unwrap();
        let page = |name: &str, text: &str| {
            whole_file::write(&made.path().join(name), text.as_bytes()).unwrap();
        };
        page("ddl/a.html", "<a href=\"ddl_star::Star\">Star</a>");
        page(
            "ddl/b.html",
            "<a href=\"../ddl_star/struct.Star.html#x::y\">Star</a>",
        );
        let found = unresolved(made.path()).unwrap();
        assert!(
            found.len() == 1 && found[0].ends_with("a.html"),
            "{found:?}"
        );
    }

    #[test]
    fn links_to_pages_of_the_guide_lead_there() {
        let out = tempfile::tempdir().unwrap();
        let page = out.path().join("ddl_goal/index.html");
        whole_file::write(&page, b"<a href=\"../../docs/goals.md#x\">").unwrap();
        let library = Library {
            package: "ddl-goal".to_owned(),
            description: String::new(),
        };
        let shown = BTreeMap::from([(PathBuf::from("docs/goals.md"), "goals.md".to_owned())]);
        lead_to_guide(out.path(), &[library], &shown).unwrap();
        assert_eq!(
            fs::read_to_string(page).unwrap(),
            "<a href=\"../../guide/goals.html#x\">"
        );
    }

    #[test]
    fn a_folder_is_copied_without_what_is_hidden() {
        let folder = tempfile::tempdir().unwrap();
        let (from, to) = (folder.path().join("a"), folder.path().join("b"));
        fs::create_dir_all(from.join("c")).unwrap();
        for (file, text) in [("c/d.html", "x"), (".lock", "y")] {
            fs::write(from.join(file), text).unwrap();
        }
        copy(&from, &to).unwrap();
        assert_eq!(fs::read_to_string(to.join("c/d.html")).unwrap(), "x");
        assert!(!to.join(".lock").exists());
    }
}
