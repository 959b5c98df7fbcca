//! What a test can do with a command.

use ddl_tests::console::Command;
use ddl_tests::page_run::Depth;
use ddl_tests::recordings;

/// Commands that take minutes, by page and how they begin: they are begun.
pub(super) const LONG: &[(&str, &str)] = &[
    (
        "docs/training.md",
        "ddl train --data recordings --out runs/own",
    ),
    ("docs/training.md", "ddl train --fold zara1"),
    ("docs/training.md", "ddl evaluate --model runs/zara1"),
    ("docs/program.md", "ddl evaluate --fold zara1"),
    ("docs/program.md", "ddl train --data recordings"),
    ("docs/program.md", "ddl evaluate --model runs/own"),
    ("docs/program.md", "ddl forecast --model runs/own"),
    ("docs/program.md", "ddl evaluate --model runs/without-lobby"),
    ("docs/program.md", "ddl train --fold zara1"),
    ("docs/program.md", "ddl train --convention simulated"),
    ("docs/program.md", "ddl train --fold eth --only-goals"),
    ("docs/program.md", "ddl goals --model runs/eth --measure"),
];

/// Commands that another machine or another tool is needed for, by page and how they begin.
pub(super) const ELSEWHERE: &[(&str, &str, &str)] = &[
    ("docs/gpu.md", "", "on a machine with a graphics card"),
    (
        "docs/libtorch.md",
        "export LIBTORCH=",
        "where PyTorch is installed; then `cargo xtask setup`",
    ),
    (
        "docs/performance.md",
        "eval \"$(cargo xtask env)\"",
        "sets up a shell for the lines below it",
    ),
    (
        "docs/performance.md",
        "g++",
        "looks into libtorch's headers, for one figure",
    ),
    (
        "docs/performance.md",
        "for steps in",
        "needs the library of the line before",
    ),
    (
        "docs/performance.md",
        "tail",
        "reads what the line before wrote",
    ),
    (
        "docs/rust.md",
        "eval \"$(cargo xtask env)\"",
        "sets up a shell for a program elsewhere",
    ),
    (
        "crates/ddl/README.md",
        "eval \"$(cargo xtask env)\"",
        "sets up a shell for a program elsewhere",
    ),
];

/// Folds of the recordings, whose commands are begun where there are none.
const FOLDS: [&str; 5] = [
    "--fold eth",
    "--fold hotel",
    "--fold univ",
    "--fold zara1",
    "--fold zara2",
];

pub(super) fn begins(page: &str, command: &Command, (of, start): (&str, &str)) -> bool {
    page == of && command.typed.starts_with(start)
}

/// What a test can do with a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Class {
    Run(Depth),
    /// xtask's own tests read it.
    OfXtask,
    /// What it names must be in the workspace; that it builds is known.
    OfCargo,
    Elsewhere,
}

pub(super) fn class(page: &str, command: &Command, depth: fn(&str, &Command) -> Depth) -> Class {
    let typed = command.typed.as_str();
    if ELSEWHERE
        .iter()
        .any(|&(of, start, _)| begins(page, command, (of, start)))
    {
        Class::Elsewhere
    } else if typed.starts_with("cargo xtask ") {
        Class::OfXtask
    } else if typed.starts_with("cargo ") {
        Class::OfCargo
    } else {
        Class::Run(depth(page, command))
    }
}

pub(super) fn whole_or_begun(page: &str, command: &Command) -> Depth {
    let of_recordings = FOLDS.iter().any(|fold| command.typed.contains(fold))
        // reads what the line before it wrote of them
        || command.typed.contains("constant_velocity.py windows.jsonl");
    let is_long = LONG.iter().any(|&entry| begins(page, command, entry));
    if is_long || of_recordings && recordings::star_folder().is_none() {
        Depth::Begun
    } else {
        Depth::Whole
    }
}

pub(super) fn begun(_: &str, _: &Command) -> Depth {
    Depth::Begun
}
