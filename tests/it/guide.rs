//! Runs every command shown in the documentation, as far as a test can run it.

use ddl_tests::console::Command;
use ddl_tests::guide::class::{ELSEWHERE, LONG, begins, begun};
use ddl_tests::guide::{self, checkout};
use std::path::{Path, PathBuf};

/// The pages whose commands run to their end, one test each. The commands of the other pages of `docs/` are only
/// started.
macro_rules! pages {
    ($($test:ident: $path:literal,)*) => {
        $(#[test]
        fn $test() {
            guide::check($path);
        })*
        /// The same pages, and the page whose commands train (`tests/it_torch/main.rs`).
        const PAGES: &[&str] = &[$($path,)* "docs/training.md"];
    };
}

pages! {
    the_first_page: "docs/index.md",
    own_data: "docs/own-data.md",
    rust: "docs/rust.md",
    robots: "docs/robots.md",
    troubleshooting: "docs/troubleshooting.md",
    extending: "docs/extending.md",
    your_model: "docs/your-model.md",
    readme: "README.md",
    the_program: "docs/program.md",
    recordings_page: "docs/recordings.md",
}

/// The other pages of `docs/` in the guide, and the READMEs of crates without commands of the program.
fn pages_of_measurements() -> Vec<String> {
    let root = checkout();
    let files = |folder: &Path| {
        std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .collect::<Vec<_>>()
    };
    let mut pages: Vec<PathBuf> = files(&root.join("docs"));
    pages.extend(
        files(&root.join("crates"))
            .into_iter()
            .map(|folder| folder.join("README.md")),
    );
    let at_the_root = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md"];
    pages.extend(at_the_root.map(|page| root.join(page)));
    pages.retain(|page| page.extension().is_some_and(|extension| extension == "md"));
    let shown = |page: PathBuf| page.strip_prefix(&root).unwrap().to_string_lossy().into_owned();
    let mut names: Vec<String> = pages.into_iter().map(shown).collect();
    names.retain(|name| !PAGES.contains(&name.as_str()));
    names.sort();
    names
}

#[test]
fn commands_of_measurements_can_be_begun() {
    for page in pages_of_measurements() {
        guide::check_to(&page, begun);
    }
}

#[test]
fn exceptions_name_commands_that_exist() {
    let of_measurements = pages_of_measurements();
    let mut all: Vec<&str> = of_measurements.iter().map(String::as_str).collect();
    all.extend(PAGES);
    let of_page = |page| guide::commands(page).into_iter().map(move |command| (page, command));
    let shown: Vec<(&str, Command)> = all.into_iter().flat_map(of_page).collect();
    for &entry in ELSEWHERE.iter().chain(LONG) {
        let mut shown = shown.iter();
        let found = shown.any(|(page, command)| begins(page, command, entry));
        assert!(found, "no page shows {entry:?}");
    }
    assert!(shown.len() > 100, "only {} commands were found", shown.len());
}
