//! Classification of the commands on a page.

use crate::console::Command;
use crate::page_run::Depth;
use crate::recordings;

const README: &str = "README.md";
const TRAINING: &str = "docs/training.md";
const PROGRAM: &str = "docs/program.md";

/// Commands that take minutes, by page and beginning; they are only started.
pub const LONG: &[(&str, &str)] = &[
    (README, "ddl train --convention simulated"),
    (README, "ddl evaluate --model runs/plaza"),
    (TRAINING, "ddl train --data recordings --out runs/own"),
    (PROGRAM, "ddl evaluate --fold zara1"),
    (PROGRAM, "ddl train --fold zara1"),
    (PROGRAM, "ddl train --fold eth --only-goals"),
    (PROGRAM, "ddl goals --model runs/eth --measure"),
];

/// Commands that need another machine or another tool, by page and beginning: a graphics card, an installed PyTorch, a
/// shell that the line sets up, or the output of such a line.
pub const ELSEWHERE: &[(&str, &str)] = &[
    ("docs/gpu.md", ""),
    ("docs/libtorch.md", "export LIBTORCH="),
    ("docs/rust.md", "eval \"$(cargo xtask setup --env)\""),
];

/// Folds of the recordings; without recordings, their commands are only started.
const FOLDS: [&str; 5] = [
    "--fold eth",
    "--fold hotel",
    "--fold univ",
    "--fold zara1",
    "--fold zara2",
];

/// Whether a command has this page and beginning.
pub fn begins(page: &str, command: &Command, (of, start): (&str, &str)) -> bool {
    page == of && command.typed.starts_with(start)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Class {
    Run(Depth),
    /// xtask's own tests check it.
    OfXtask,
    /// The packages and targets that it names must exist; the build itself is not tested.
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
        // It reads the output of the previous line.
        || command.typed.contains("constant_velocity.py windows.jsonl");
    let is_long = LONG.iter().any(|&entry| begins(page, command, entry));
    if is_long || of_recordings && recordings::star_folder().is_none() {
        Depth::Begun
    } else {
        Depth::Whole
    }
}

/// The depth for pages on which all commands are only started.
pub fn begun(_: &str, _: &Command) -> Depth {
    Depth::Begun
}
