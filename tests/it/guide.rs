//! Runs every command shown in the documentation, as far as a test can run it.

use ddl_tests::guide::{self, ELSEWHERE, LONG, begins, checkout};
use std::collections::BTreeSet;
use std::path::Path;

/// Pages with many commands, one test each.
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
    own_data: "docs/own-data.md",
    robots: "docs/robots.md",
    troubleshooting: "docs/troubleshooting.md",
    your_model: "docs/your-model.md",
    the_program: "docs/program.md",
}

/// The pages of `docs/`, the READMEs of the crates, and the pages of the workspace's folder.
fn pages() -> BTreeSet<String> {
    let files = |folder: &str| {
        let entries = std::fs::read_dir(checkout().join(folder)).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let folder = folder.to_owned();
        names.map(move |name| format!("{folder}{name}"))
    };
    let readmes = files("crates/").map(|folder| format!("{folder}/README.md"));
    let paths = files("").chain(files("docs/")).chain(readmes);
    paths
        .filter(|path| Path::new(path).extension().is_some_and(|extension| extension == "md"))
        .filter(|path| checkout().join(path).is_file())
        .collect()
}

#[test]
fn the_other_pages() {
    let pages = pages();
    assert!(pages.len() > 30, "{pages:?}");
    for page in pages.iter().filter(|page| !PAGES.contains(&page.as_str())) {
        guide::check(page);
    }
}

#[test]
fn exceptions_name_commands_that_exist() {
    let pages = pages();
    let commands: Vec<_> = pages.iter().map(|page| (page, guide::commands(page))).collect();
    for entry in ELSEWHERE.lines().chain(LONG.lines()) {
        let shows = |(page, commands): &(&String, Vec<_>)| commands.iter().any(|one| begins(page, one, entry));
        assert!(commands.iter().any(shows), "no page shows {entry:?}");
    }
    let count: usize = commands.iter().map(|(_, commands)| commands.len()).sum();
    assert!(count > 100, "only {count} commands");
}
