//! What a test can do with a command.

use crate::console::Command;
use crate::page_run::Depth;
use crate::recordings;

const README: &str = "README.md";
const TRAINING: &str = "docs/training.md";
const PROGRAM: &str = "docs/program.md";
const PERFORMANCE: &str = "docs/performance.md";

/// Commands that take minutes, by page and how they begin: they are begun.
pub const LONG: &[(&str, &str)] = &[
    (README, "ddl train --convention simulated"),
    (README, "ddl evaluate --model runs/plaza"),
    (TRAINING, "ddl train --data recordings --out runs/own"),
    (TRAINING, "ddl train --fold zara1"),
    (TRAINING, "ddl evaluate --model runs/zara1"),
    (PROGRAM, "ddl evaluate --fold zara1"),
    (PROGRAM, "ddl train --fold zara1"),
    (PROGRAM, "ddl train --fold eth --only-goals"),
    (PROGRAM, "ddl goals --model runs/eth --measure"),
];

/// Commands that another machine or another tool is needed for, by page and how they begin: on a machine with a graphics card, where
/// PyTorch is installed, in a shell that the line sets up, or by what such a line wrote.
pub const ELSEWHERE: &[(&str, &str)] = &[
    ("docs/gpu.md", ""),
    ("docs/libtorch.md", "export LIBTORCH="),
    (PERFORMANCE, "eval \"$(cargo xtask env)\""),
    (PERFORMANCE, "g++"),
    (PERFORMANCE, "for steps in"),
    (PERFORMANCE, "tail"),
    ("docs/rust.md", "eval \"$(cargo xtask env)\""),
];

/// Folds of the recordings, whose commands are begun where there are none.
const FOLDS: [&str; 5] = [
    "--fold eth",
    "--fold hotel",
    "--fold univ",
    "--fold zara1",
    "--fold zara2",
];

/// Whether a command is one of those.
pub fn begins(page: &str, command: &Command, (of, start): (&str, &str)) -> bool {
    page == of && command.typed.starts_with(start)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Class {
    Run(Depth),
    /// xtask's own tests read it.
    OfXtask,
    /// What it names must be in the workspace; that it builds is known.
    OfCargo,
    Elsewhere,
}

pub(super) fn of(page: &str, command: &Command, depth: fn(&str, &Command) -> Depth) -> Class {
    let typed = command.typed.as_str();
    if ELSEWHERE.iter().any(|&entry| begins(page, command, entry)) {
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

/// None is run to its end.
pub fn begun(_: &str, _: &Command) -> Depth {
    Depth::Begun
}
