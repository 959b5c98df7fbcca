//! Commands that the documentation shows. Commands that [`class`] does not name run to their end, and must print what
//! their page shows. A test of xtask checks the arguments of `cargo xtask` (`xtask/src/command/docs.rs`). With the
//! variable `DDL_WRITE_SHOWN`, output on a page that differs is replaced.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

pub mod class;
mod shown;

use crate::console::{self, Command};
use crate::page_run::{Depth, PageFolder};
use crate::{drawn_model, folder_contents, recordings};
use class::Class;
use ddl::Variant;
use std::path::{Path, PathBuf};

/// The folder of the workspace.
pub fn checkout() -> PathBuf {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.parent().unwrap().to_path_buf()
}

/// The commands of a page, given by its path in the workspace.
pub fn commands(page: &str) -> Vec<Command> {
    console::commands(&text_of(page))
}

fn text_of(page: &str) -> String {
    std::fs::read_to_string(checkout().join(page)).unwrap_or_else(|error| panic!("{page}: {error}"))
}

/// Runs the commands of a page to their ends.
pub fn check(page: &str) {
    check_to(page, class::whole_or_begun);
}

/// Runs the commands of a page, each as far as `depth` determines.
pub fn check_to(page: &str, depth: fn(&str, &Command) -> Depth) {
    let text = text_of(page);
    let commands = console::commands(&text);
    let folder = PageFolder::new(&checkout(), recordings::star_folder());
    if text.contains("--model runs/zara1") {
        let run = folder.path().join("runs/zara1");
        folder_contents::write(drawn_model::contents(Variant::Full), &run);
    }
    let mut to_run = Vec::new();
    for command in &commands {
        match class::of(page, command, depth) {
            Class::Run(depth) => to_run.push((command, depth)),
            Class::OfCargo => check_cargo(page, command),
            Class::OfXtask | Class::Elsewhere => {}
        }
    }
    let problems = folder.run(&to_run);
    if std::env::var_os("DDL_WRITE_SHOWN").is_some() {
        let answers = problems.iter().filter_map(|(i, problem)| {
            let (command, _) = to_run[*i];
            Some((command, problem.answer.as_deref()?))
        });
        let text = shown::replaced(&text, answers);
        std::fs::write(checkout().join(page), text).unwrap();
    }
    let faults: Vec<String> = problems.into_iter().map(|(_, problem)| problem.text).collect();
    assert!(faults.is_empty(), "{page}\n{}", faults.join("\n"));
}

/// Checks that the packages, examples, benchmarks and tests named in a call of cargo exist.
fn check_cargo(page: &str, command: &Command) {
    let words = command
        .words()
        .unwrap_or_else(|| panic!("{page}:{}: not a plain call of cargo", command.line));
    let after = |option: &str| words.iter().skip_while(|&&word| word != option).nth(1).copied();
    let package = after("-p").unwrap_or_else(|| panic!("{page}:{}: no package is named", command.line));
    let of_tests = package == "ddl-tests";
    let folder = checkout().join(match package {
        "ddl-tests" => "tests".to_owned(),
        "ddl-forecast" => "crates/ddl".to_owned(),
        _ => format!("crates/{package}"),
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
