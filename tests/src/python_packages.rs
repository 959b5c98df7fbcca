//! Python packages that a page of the documentation uses, of pinned versions, in the build folder.

use crate::skip::skip;
use std::error::Error;
use std::path::PathBuf;
use std::process::Command;

const REQUIREMENTS: [&str; 2] = ["pandas==2.3.3", "matplotlib==3.10.7"];
/// Packages are compiled for one minor version of Python.
const VERSION: &str =
    "import sys; print('%s-%d.%d' % (sys.implementation.name, *sys.version_info[:2]))";
const PIP: &str = "-m pip install --quiet --only-binary=:all: --no-cache-dir --disable-pip-version-check --timeout 60 --retries 3 --target";

/// The folder for Python's search path; fetched with pip when it is not there. `None` where that cannot be.
pub fn ensure() -> Option<PathBuf> {
    let because = |problem| skip(format!("no {}: {problem}", REQUIREMENTS.join(" and ")));
    find_or_fetch().map_or_else(because, Some)
}

fn find_or_fetch() -> Result<PathBuf, Box<dyn Error>> {
    let version = answer(Command::new("python3").args(["-c", VERSION]))?;
    let name = REQUIREMENTS.join("-").replace("==", "-");
    // The build folder that this program lies in: `target/debug/deps/NAME`.
    let program = std::env::current_exe()?;
    let parent = program
        .ancestors()
        .nth(3)
        .ok_or("no build folder")?
        .join("tools");
    let folder = parent.join(format!("{name}-{}", version.trim()));
    if !folder.is_dir() {
        std::fs::create_dir_all(&parent)?;
        // It takes its name at the very end.
        let work = tempfile::tempdir_in(&parent)?;
        let target = work.path().join("packages");
        let mut pip = Command::new("python3");
        answer(pip.args(PIP.split(' ')).arg(&target).args(REQUIREMENTS))?;
        let renamed = std::fs::rename(&target, &folder);
        if !folder.is_dir() {
            renamed?; // nobody else was faster
        }
    }
    Ok(folder)
}

fn answer(command: &mut Command) -> Result<String, Box<dyn Error>> {
    let output = command.output()?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    let mut lines = said.lines().rev().filter(|line| !line.trim().is_empty());
    Err(lines.next().unwrap_or("pip failed").into())
}
