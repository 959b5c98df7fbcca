//! Every command that the documentation shows is run, as far as a test can run it.
//!
//! Whatever is not named below runs to its end and must answer as its page says. Calls of `cargo xtask` are held to its own
//! arguments by a test of xtask (`xtask/src/command/docs.rs`).

mod class;
mod python;

use class::{Class, ELSEWHERE, LONG, begins, begun, class, whole_or_begun};
use ddl::Variant;
use ddl_tests::console::{self, Command};
use ddl_tests::page_run::{Depth, PageFolder};
use ddl_tests::{recordings, tiny_model};
use std::path::{Path, PathBuf};

/// The pages whose commands run to their end; each is a test. Of `docs/` beside them, commands are begun.
macro_rules! pages {
    ($($test:ident: $path:literal,)*) => {
        $(#[test]
        fn $test() {
            check($path, whole_or_begun);
        })*
        const PAGES: &[&str] = &[$($path),*];
    };
}

pages! {
    the_first_page: "docs/index.md",
    start: "docs/start.md",
    own_data: "docs/own-data.md",
    python_page: "docs/python.md",
    rust: "docs/rust.md",
    robots: "docs/robots.md",
    troubleshooting: "docs/troubleshooting.md",
    training: "docs/training.md",
    extending: "docs/extending.md",
    your_model: "docs/your-model.md",
    readme: "README.md",
    the_program: "docs/program.md",
    readme_of_the_facade: "crates/ddl/README.md",
    recordings_page: "docs/recordings.md",
}

fn checkout() -> PathBuf {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.parent().unwrap().to_path_buf()
}

fn text_of(page: &str) -> String {
    std::fs::read_to_string(checkout().join(page)).unwrap_or_else(|error| panic!("{page}: {error}"))
}

fn check(page: &str, depth: fn(&str, &Command) -> Depth) {
    let text = text_of(page);
    let commands = console::commands(&text);
    let folder = PageFolder::new(&checkout(), recordings::star_folder());
    if text.contains("--model runs/zara1") {
        let runs = folder.path().join("runs");
        std::fs::create_dir_all(&runs).unwrap();
        let kept = tiny_model::folder(Variant::Full).keep();
        std::fs::rename(&kept, runs.join("zara1")).unwrap();
    }
    let mut to_run = Vec::new();
    for command in &commands {
        match class(page, command, depth) {
            Class::Run(depth) => to_run.push((command, depth)),
            Class::OfCargo => check_cargo(page, command),
            Class::OfXtask | Class::Elsewhere => {}
        }
    }
    let faults = folder.run(&to_run);
    assert!(faults.is_empty(), "{page}\n{}", faults.join("\n"));
    python::run(page, &text, &folder);
}

/// Packages, examples, benchmarks and tests that a call of cargo names exist.
fn check_cargo(page: &str, command: &Command) {
    let words = command
        .words()
        .unwrap_or_else(|| panic!("{page}:{}: more than a plain call of cargo", command.line));
    let after = |option: &str| {
        words
            .iter()
            .skip_while(|&&word| word != option)
            .nth(1)
            .copied()
    };
    let package = after("-p").unwrap_or_else(|| panic!("{page}:{}: of no package", command.line));
    let of_tests = package == "ddl-tests";
    let folder = checkout().join(if of_tests {
        "tests".to_owned()
    } else {
        format!("crates/{package}")
    });
    assert!(
        folder.join("Cargo.toml").is_file(),
        "{page}:{}: no package {package}",
        command.line
    );
    for (option, place) in [
        ("--example", "examples"),
        ("--bench", "benches"),
        ("--test", if of_tests { "." } else { "tests" }),
    ] {
        let Some(name) = after(option) else { continue };
        let at = folder.join(place).join(name);
        assert!(
            at.is_dir() || at.with_extension("rs").is_file(),
            "{page}:{}: no {option} {name}",
            command.line
        );
    }
}

/// The other pages of `docs/`, and the READMEs of crates that show no program.
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
    pages.extend([root.join("README.md"), root.join("CHANGELOG.md")]);
    pages.retain(|page| page.extension().is_some_and(|extension| extension == "md"));
    let shown = |page: PathBuf| {
        page.strip_prefix(&root)
            .unwrap()
            .to_string_lossy()
            .into_owned()
    };
    let mut names: Vec<String> = pages.into_iter().map(shown).collect();
    names.retain(|name| !PAGES.contains(&name.as_str()));
    names.sort();
    names
}

#[test]
fn commands_of_measurements_can_be_begun() {
    for page in pages_of_measurements() {
        check(&page, begun);
    }
}

#[test]
fn exceptions_are_of_commands_that_are_shown() {
    let all = PAGES
        .iter()
        .map(|&page| page.to_owned())
        .chain(pages_of_measurements());
    let shown: Vec<(String, Command)> = all
        .flat_map(|page| {
            console::commands(&text_of(&page))
                .into_iter()
                .map(move |command| (page.clone(), command))
        })
        .collect();
    let entries = ELSEWHERE
        .iter()
        .map(|&(page, start, _)| (page, start))
        .chain(LONG.iter().copied());
    for entry in entries {
        assert!(
            shown
                .iter()
                .any(|(page, command)| begins(page, command, entry)),
            "nobody shows {entry:?}"
        );
    }
    assert!(
        shown.len() > 100,
        "only {} commands were found",
        shown.len()
    );
}
