//! A browser, and what drives it: for the checks of pages.

mod chromium;
mod playwright;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

use crate::python::Python;

/// Installations and checks take minutes; beyond this something hangs.
const LIMIT: Duration = Duration::from_mins(15);

#[derive(Debug)]
pub(crate) struct Browser {
    program: PathBuf,
    python: Python,
    modules: PathBuf,
}

impl Browser {
    /// Finds both; what is missing is installed where that is possible, or the error says what to install.
    pub(crate) fn ready() -> Result<Self> {
        let program = chromium::find_or_install()?;
        let python = Python::find()?;
        let modules = playwright::ensure(&python)?;
        Ok(Self {
            program,
            python,
            modules,
        })
    }

    /// Runs a Python script that drives the browser with Playwright: `script FOLDER --browser PROGRAM MORE...`.
    pub(crate) fn run_check<'a>(
        &self,
        script: &Path,
        folder: &Path,
        more: impl IntoIterator<Item = &'a Path>,
    ) -> Result<()> {
        let mut command = self.python.file(script);
        command
            .arg(folder)
            .arg("--browser")
            .arg(&self.program)
            .args(more)
            .env("PYTHONPATH", &self.modules)
            .env("PYTHONDONTWRITEBYTECODE", "1");
        run_within(&mut command, LIMIT)
            .with_context(|| format!("the check with {} failed (above)", self.program.display()))
    }
}

/// Runs a program to its end; one that fails, or is not done in time and is then stopped, is an error.
fn run_within(command: &mut Command, limit: Duration) -> Result<()> {
    let name = command.get_program().display().to_string();
    let mut child = command
        .spawn()
        .with_context(|| format!("{name} cannot be started"))?;
    let start = Instant::now();
    loop {
        match child.try_wait().context("a program is lost")? {
            Some(status) if status.success() => return Ok(()),
            Some(status) => bail!("{name} failed: {status}"),
            None if start.elapsed() < limit => sleep(Duration::from_millis(50)),
            None => {
                child.kill().context("a program cannot be stopped")?;
                child.wait().context("a program is lost")?;
                bail!(
                    "{name} was not done after {} s and was stopped",
                    limit.as_secs()
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ends_well_fails_or_hangs_is_told_apart() {
        let run = |script: &str, limit| {
            let mut shell = Command::new("sh");
            let outcome = run_within(shell.args(["-c", script]), Duration::from_millis(limit));
            outcome.map_err(|error| error.to_string())
        };
        assert_eq!(run("exit 0", 60_000), Ok(()));
        let failed = run("exit 3", 60_000).unwrap_err();
        assert!(
            failed.contains("sh failed") && failed.contains('3'),
            "{failed}"
        );
        let stopped = run("exec sleep 60", 100).unwrap_err();
        assert!(stopped.contains("was stopped"), "{stopped}");
    }
}
