//! What the tests of faults found, as numbers: written to a file where somebody asked for it, and then in full.

use std::fmt::Display;
use std::fs::OpenOptions;
use std::io::Write as _;

/// Names the file of the figures. Set by `cargo xtask faults`; with it, every fault is tried the full number of times.
const VARIABLE: &str = "DDL_FAULTS_FIGURES";

/// Whether the full number of rounds is asked for.
pub fn are_asked_for() -> bool {
    file().is_some()
}

/// How often something is tried: `few` times among all tests, `many` times for the figures.
pub fn rounds<T>(few: T, many: T) -> T {
    if are_asked_for() { many } else { few }
}

/// Tells a figure: a row of a table, which is printed, and added to the file where one is named.
pub fn tell(fault: &str, tried: impl Display, found: impl Display) {
    let row = format!("| {fault} | {tried} | {found} |\n");
    eprint!("{row}");
    if let Some(file) = file() {
        let file = OpenOptions::new().create(true).append(true).open(file);
        let mut file = file.expect("the file of the figures can be opened");
        file.write_all(row.as_bytes())
            .expect("the file of the figures can be written");
    }
}

fn file() -> Option<std::ffi::OsString> {
    std::env::var_os(VARIABLE).filter(|value| !value.is_empty())
}
