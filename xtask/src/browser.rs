//! A browser, and what drives it: for the check of the report page.

mod chromium;
mod patience;
mod playwright;

use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result};

use crate::python::Python;

/// The check takes a minute or two; beyond this something hangs.
const LIMIT: Duration = Duration::from_mins(15);

/// Runs a Python script that drives a browser with Playwright: `script FOLDER --browser PROGRAM MORE...`.
pub(crate) fn run_check<'a>(
    script: &Path,
    folder: &Path,
    more: impl IntoIterator<Item = &'a Path>,
) -> Result<()> {
    let browser = chromium::find_or_install()?;
    let python = Python::find()?;
    let modules = playwright::ensure(&python)?;
    let mut command = python.file(script);
    command
        .arg(folder)
        .arg("--browser")
        .arg(&browser)
        .args(more);
    command
        .env("PYTHONPATH", &modules)
        .env("PYTHONDONTWRITEBYTECODE", "1");
    patience::run_within(&mut command, LIMIT)
        .with_context(|| format!("the check with {} failed (above)", browser.display()))
}
