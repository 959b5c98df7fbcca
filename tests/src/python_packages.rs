//! Python packages that a page of the documentation uses, of pinned versions, in the build folder.

use std::path::{Path, PathBuf};
use std::process::Command;

/// What is installed; the folder is named after it.
const REQUIREMENTS: [&str; 2] = ["pandas==2.3.3", "matplotlib==3.10.7"];

/// The folder for Python's search path; fetched with pip when it is not there. `None`, with the reason printed, where that cannot be.
pub fn ensure() -> Option<PathBuf> {
    match find_or_fetch() {
        Ok(folder) => Some(folder),
        Err(problem) if std::env::var_os("CI").is_some_and(|value| !value.is_empty()) => {
            panic!("CI needs {}: {problem}", REQUIREMENTS.join(" and "))
        }
        Err(problem) => {
            eprintln!("skipped, no {}: {problem}", REQUIREMENTS.join(" and "));
            None
        }
    }
}

fn find_or_fetch() -> Result<PathBuf, String> {
    // Packages are compiled for one minor version of Python.
    let version = answer(Command::new("python3").args([
        "-c",
        "import sys; print('%s-%d.%d' % (sys.implementation.name, *sys.version_info[:2]))",
    ]))?;
    let name = REQUIREMENTS.join("-").replace("==", "-");
    let parent = build_folder()?.join("tools");
    let folder = parent.join(format!("{name}-{}", version.trim()));
    if !folder.is_dir() {
        fetch(&parent, &folder)?;
    }
    Ok(folder)
}

/// Everything happens in a temporary folder beside it, which takes its name at the very end.
fn fetch(parent: &Path, folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(parent).map_err(|error| format!("{}: {error}", parent.display()))?;
    let work = tempfile::Builder::new()
        .prefix(".python-incoming-")
        .tempdir_in(parent)
        .map_err(|error| format!("{}: {error}", parent.display()))?;
    let target = work.path().join("packages");
    let arguments = "-m pip install --quiet --only-binary=:all: --no-cache-dir --disable-pip-version-check --timeout 60 --retries 3 --target";
    let mut pip = Command::new("python3");
    pip.args(arguments.split(' '))
        .arg(&target)
        .args(REQUIREMENTS);
    answer(&mut pip)?;
    match std::fs::rename(&target, folder) {
        Err(_) if folder.is_dir() => Ok(()), // somebody else was faster
        outcome => outcome.map_err(|error| format!("{}: {error}", folder.display())),
    }
}

/// The build folder that this program lies in: `target/debug/deps/NAME`.
fn build_folder() -> Result<PathBuf, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let folder = program.ancestors().nth(3).map(Path::to_path_buf);
    folder.ok_or_else(|| format!("{} lies in no build folder", program.display()))
}

fn answer(command: &mut Command) -> Result<String, String> {
    let output = command
        .output()
        .map_err(|error| format!("python3 cannot be started: {error}"))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    Err(said
        .lines()
        .rfind(|line| !line.trim().is_empty())
        .unwrap_or("pip failed")
        .to_owned())
}
