//! Results of the tests of faults, written to a file on request.

use std::fmt::Display;
use std::fs::OpenOptions;
use std::io::Write as _;

/// Environment variable with the file of the figures, set by `cargo xtask nightly faults`. If set, every fault is tried
/// the full number of times.
const VARIABLE: &str = "DDL_FAULTS_FIGURES";

/// Whether the full number of rounds is requested.
pub fn are_asked_for() -> bool {
    file().is_some()
}

/// The number of repetitions: `few` in a normal test run, `many` for the figures.
pub fn rounds<T>(few: T, many: T) -> T {
    if are_asked_for() { many } else { few }
}

/// Reports a figure: a row of a table, which is printed, and appended to the file of the figures if there is one.
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
