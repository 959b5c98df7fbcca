//! Programs that this one starts.

use anyhow::{Context, Result, bail, ensure};
use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Prints the command and runs it to its end. A failure is an error.
pub(crate) fn run(command: &mut Command) -> Result<()> {
    let line = shown(command);
    eprintln!("$ {line}");
    let status =
        command.stdin(Stdio::null()).status().with_context(|| format!("{} cannot be started", name(command)))?;
    ensure!(status.success(), "`{line}` failed: {status}");
    Ok(())
}

/// Runs a command silently and returns what it prints. The error is the last line of its standard error.
pub(crate) fn read(command: &mut Command) -> Result<String> {
    let output =
        command.stdin(Stdio::null()).output().with_context(|| format!("{} cannot be started", name(command)))?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr);
        let last = text.lines().map(str::trim).rfind(|line| !line.is_empty());
        bail!("{}", last.unwrap_or("it stopped without an error message"));
    }
    String::from_utf8(output.stdout).with_context(|| format!("the output of {} is not text", name(command)))
}

fn name(command: &Command) -> String {
    command.get_program().display().to_string()
}

/// The file name of the program and its first arguments, for messages.
pub(crate) fn shown(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or_default();
    let words = [program].into_iter().chain(command.get_args());
    let words: Vec<String> = words.map(|word| word.display().to_string()).collect();
    let line = words.join(" ").lines().next().unwrap_or_default().to_owned();
    line.char_indices().nth(200).map_or(line.clone(), |(end, _)| format!("{} ...", &line[..end]))
}

/// The program of this name on the search path (or the path itself, if it is one).
pub(crate) fn find_on_path(name: &OsStr) -> Option<PathBuf> {
    if Path::new(name).components().count() > 1 {
        return Path::new(name).is_file().then(|| name.into());
    }
    let path = env::var_os("PATH")?;
    let mut file = name.to_owned();
    file.push(env::consts::EXE_SUFFIX);
    env::split_paths(&path).map(|folder| folder.join(&file)).find(|program| program.is_file())
}
