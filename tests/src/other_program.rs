//! The other program of `docs/your-model.md`: constant velocity in Python, as a user runs it.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Lets the example forecast `windows.jsonl` of a folder into `forecasts.jsonl` there; false, with the reason
/// printed, where there is no Python.
///
/// # Panics
/// If the example fails, or Python is missing and the variable `CI` is set.
#[must_use]
pub fn forecasts_in(folder: &Path) -> bool {
    let example = [
        env!("CARGO_MANIFEST_DIR"),
        "..",
        "crates",
        "ddl-cli",
        "examples",
        "constant_velocity.py",
    ];
    let output = Command::new("python3")
        .arg(example.iter().collect::<PathBuf>())
        .args(["windows.jsonl", "forecasts.jsonl"])
        .current_dir(folder)
        .output();
    match output {
        Ok(output) => {
            assert!(output.status.success(), "{output:?}");
            true
        }
        Err(error) if std::env::var_os("CI").is_some_and(|value| !value.is_empty()) => {
            panic!("CI needs python3: {error}")
        }
        Err(error) => {
            eprintln!("skipped, python3 cannot be started: {error}");
            false
        }
    }
}
