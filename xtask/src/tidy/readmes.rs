//! A crate's README is read on the registry's page and in its documentation, where no checkout is around it.
//!
//! So links lead to other pages by whole addresses, those into this repository to files that are there, and every example is linked.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::Value;

use super::Findings;

/// Between the repository's address and a path in it.
const BRANCH: &str = "/blob/main/";

pub(super) fn check(
    metadata: &Value,
    files: &[PathBuf],
    root: &Path,
    findings: &mut Findings,
) -> Result<()> {
    for package in metadata["packages"].as_array().into_iter().flatten() {
        let folder = package["manifest_path"].as_str().map(Path::new);
        let folder = folder.and_then(|manifest| manifest.parent()?.strip_prefix(root).ok());
        let Some(folder) = folder.filter(|_| package["publish"].is_null()) else {
            continue;
        };
        let readme = folder.join("README.md");
        if !files.contains(&readme) {
            continue; // another check says so
        }
        let text = fs::read_to_string(root.join(&readme))
            .with_context(|| format!("{} cannot be read", readme.display()))?;
        let repository = package["repository"].as_str().unwrap_or("");
        check_links(&readme, &text, repository, files, findings);
        for example in files.iter().filter_map(|file| example_name(folder, file)) {
            if !text.contains(&format!("examples/{example}")) {
                findings.fault(format!(
                    "{}: the example {example} is not linked",
                    readme.display()
                ));
            }
        }
    }
    Ok(())
}

/// `NAME` of `examples/NAME.rs` and `examples/NAME/main.rs` of the crate in `folder`.
fn example_name(folder: &Path, file: &Path) -> Option<String> {
    let within = file.strip_prefix(folder.join("examples")).ok()?;
    let parts: Vec<&str> = within.iter().filter_map(|part| part.to_str()).collect();
    match parts.as_slice() {
        [name, "main.rs"] => Some((*name).to_owned()),
        [name] => name.strip_suffix(".rs").map(str::to_owned),
        _ => None,
    }
}

fn check_links(
    readme: &Path,
    text: &str,
    repository: &str,
    files: &[PathBuf],
    findings: &mut Findings,
) {
    for (number, line) in (1..).zip(text.lines()) {
        for target in targets(line) {
            let at = format!("{}:{number}", readme.display());
            if let Some(path) = target
                .strip_prefix(repository)
                .and_then(|rest| rest.strip_prefix(BRANCH))
            {
                let path = path.split('#').next().unwrap_or(path);
                if !files.iter().any(|file| file.starts_with(path)) {
                    findings.fault(format!("{at}: there is no {path} in the repository"));
                }
            } else if !target.starts_with("https://") && is_path(target) {
                findings.fault(format!(
                    "{at}: {target}: a crate's page stands alone: link {repository}{BRANCH}..."
                ));
            }
        }
    }
}

/// A path in a checkout, as opposed to an item of the crate or a place on the page.
fn is_path(target: &str) -> bool {
    let is_page = Path::new(target).extension().is_some_and(|e| e == "md");
    !target.starts_with('#') && (target.contains('/') || is_page)
}

/// What the links of a line of markdown lead to.
fn targets(line: &str) -> impl Iterator<Item = &str> {
    line.split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faults(text: &str) -> Vec<String> {
        let mut findings = Findings::default();
        let files = [PathBuf::from("docs/goals.md")];
        let readme = Path::new("crates/a/README.md");
        check_links(readme, text, "https://host/x", &files, &mut findings);
        findings.faults
    }

    #[test]
    fn links_out_of_the_package_are_whole_and_lead_somewhere() {
        assert_eq!(
            faults("[a](https://host/x/blob/main/docs/goals.md#top), [b](https://other/y)"),
            [] as [&str; 0]
        );
        assert_eq!(
            faults("[`Flow::chart`](Flow::chart), [c](#shapes)"),
            [] as [&str; 0]
        );
        let gone = faults("first\n[a](https://host/x/blob/main/docs/gone.md)");
        assert_eq!(
            gone,
            ["crates/a/README.md:2: there is no docs/gone.md in the repository"]
        );
        for path in ["../../docs/goals.md", "docs/goals.md", "NOTES.md"] {
            assert_eq!(faults(&format!("[a]({path})")).len(), 1, "{path}");
        }
    }

    #[test]
    fn examples_are_told_by_their_files() {
        let name = |file: &str| example_name(Path::new("crates/a"), Path::new(file));
        assert_eq!(
            name("crates/a/examples/reaching.rs").as_deref(),
            Some("reaching")
        );
        assert_eq!(
            name("crates/a/examples/around/main.rs").as_deref(),
            Some("around")
        );
        for file in [
            "crates/a/examples/around/picture.rs",
            "crates/a/src/lib.rs",
            "crates/a/examples/x.py",
        ] {
            assert_eq!(name(file), None, "{file}");
        }
    }
}
