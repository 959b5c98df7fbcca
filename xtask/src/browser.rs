//! A browser and its driver, for the checks of pages.

mod chromium;
mod playwright;

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result};

use crate::process::run_within;
use crate::python::Python;

/// Installations and checks take minutes; after this time they are assumed to hang.
const LIMIT: Duration = Duration::from_mins(15);

#[derive(Debug)]
pub(crate) struct Browser {
    program: PathBuf,
    python: Python,
    modules: PathBuf,
}

impl Browser {
    /// Finds the browser and the driver. A missing one is installed if possible; otherwise the error names what to
    /// install.
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
