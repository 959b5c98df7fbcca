//! Links between files of the repository are relative. A crate's README is also shown in a registry and as the first
//! page of the crate's interface. So it links only to items of the crate, and names other files without links. Links
//! inside `docs/` are also checked on the site (`cargo xtask docs`).

use std::path::{Component, Path, PathBuf};

pub(super) fn faults(file: &Path, text: &str, files: &[PathBuf]) -> Vec<String> {
    if file.extension().is_none_or(|extension| extension != "md") {
        return Vec::new();
    }
    let at = file.display();
    let mut faults: Vec<String> = targets(text)
        .filter_map(|target| Some(format!("{at}: {target}: {}", fault(file, target, files)?)))
        .collect();
    if file.ends_with("README.md") && file.starts_with("crates") {
        let folder = file.with_file_name("examples");
        let examples = files.iter().filter_map(|file| example_name(&folder, file));
        let missing = examples.filter(|name| !text.contains(&format!("`{name}`")));
        faults.extend(missing.map(|name| format!("{at}: the example {name} is not named")));
    }
    faults
}

fn fault(file: &Path, target: &str, files: &[PathBuf]) -> Option<&'static str> {
    let target = target.split('#').next().unwrap_or_default();
    let is_there = |path: &Path| files.iter().any(|file| file.starts_with(path));
    // In a crate's README, a path without a slash and without an extension is an item of the crate.
    let in_crate = file.starts_with("crates");
    let is_page = Path::new(target).extension().is_some_and(|end| end == "md");
    let is_path = target.contains('/') || is_page || !in_crate;
    if target.is_empty() || target.contains(':') || !is_path {
        return None;
    }
    let path = joined(file.parent()?, target);
    if in_crate {
        return Some("this page is read elsewhere, too: name the file in words");
    }
    (!is_there(&path)).then_some("the file does not exist")
}

/// `folder/relative` without `.` and `..`.
fn joined(folder: &Path, relative: &str) -> PathBuf {
    let mut path = PathBuf::new();
    for part in folder.join(relative).components() {
        match part {
            Component::ParentDir => drop(path.pop()),
            Component::CurDir => {}
            other => path.push(other),
        }
    }
    path
}

/// `NAME` of `NAME.rs` and `NAME/main.rs` in the folder of examples.
fn example_name(examples: &Path, file: &Path) -> Option<String> {
    let within = file.strip_prefix(examples).ok()?;
    let name = match within.parent()?.to_str()? {
        "" => within.to_str()?.strip_suffix(".rs")?,
        folder => within.ends_with("main.rs").then_some(folder)?,
    };
    Some(name.to_owned())
}

/// The targets of the links of a page, outside code blocks.
fn targets(text: &str) -> impl Iterator<Item = &str> {
    let mut in_code = false;
    let prose = text.lines().filter(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        in_code ^= is_fence;
        !in_code && !is_fence
    });
    let links = prose.flat_map(|line| line.split("](").skip(1));
    links.filter_map(|rest| rest.split([')', ' ']).next())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(file: &str, text: &str) -> Vec<String> {
        let files = [
            "docs/goals.md",
            "crates/a/examples/one.rs",
            "crates/a/examples/two/main.rs",
            "README.md",
        ];
        faults(Path::new(file), text, &files.map(PathBuf::from))
    }

    #[test]
    fn links_that_lead_somewhere_pass() {
        for (file, text) in [
            ("docs/x.md", "[a](../README.md#top), [b](https://other/y), [c](#d)"),
            ("docs/x.md", "[a](goals.md#b)\n```\n[a](b.md)\n```\n"),
            ("README.md", "[a](docs/goals.md) ![b](docs)"),
            ("datasets/README.md", "[a](../docs/goals.md)"),
            ("crates/b/README.md", "[`Flow::chart`](Flow::chart) [c](Flow)"),
        ] {
            assert_eq!(found(file, text), [] as [&str; 0], "{file}");
        }
    }

    #[test]
    fn links_that_lead_nowhere_or_only_from_here_are_named() {
        for (file, text, needle) in [
            ("docs/x.md", "[a](../gone.md)", "../gone.md: the file does not exist"),
            (
                "README.md",
                "[a](docs/gone.md)",
                "docs/gone.md: the file does not exist",
            ),
            ("crates/b/README.md", "[a](../../docs/goals.md)", "in words"),
            ("crates/b/README.md", "[a](NOTES.md)", "in words"),
        ] {
            let found = found(file, text);
            assert!(found.len() == 1 && found[0].contains(needle), "{found:?}");
        }
    }

    #[test]
    fn every_example_is_named() {
        assert_eq!(
            found("crates/a/README.md", "The example `one` shows it."),
            ["crates/a/README.md: the example two is not named"]
        );
    }
}
