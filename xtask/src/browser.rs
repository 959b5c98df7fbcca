//! A browser and its driver, for the checks of pages.

use crate::debian;
use crate::process::{find_on_path, run};
use crate::tools::Tools;
use crate::workspace::Workspace;
use anyhow::{Context, Result};
use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

const NAMES: &str = "chromium chromium-browser google-chrome google-chrome-stable chrome";

/// Runs a Python script that drives the browser with Playwright: `script FOLDER --browser PROGRAM [--screenshots DIR]`.
pub(crate) fn check(workspace: &Workspace, script: &str, folder: &Path, screenshots: Option<&Path>) -> Result<()> {
    let browser = find_or_install()?;
    let mut command = Tools::ensure(workspace)?.python(&workspace.path(script));
    command.arg(folder).arg("--browser").arg(&browser);
    if let Some(folder) = screenshots {
        command.arg("--screenshots").arg(folder);
    }
    run(&mut command).with_context(|| format!("the check with {} failed (above)", browser.display()))
}

/// `$DDL_BROWSER`, a Chromium on the search path, or a newly installed one.
pub(crate) fn find_or_install() -> Result<PathBuf> {
    if let Some(named) = env::var_os("DDL_BROWSER").filter(|value| !value.is_empty()) {
        return find_on_path(&named).with_context(|| format!("DDL_BROWSER={} is not a program", named.display()));
    }
    let find = || NAMES.split(' ').find_map(|name| find_on_path(OsStr::new(name)));
    if let Some(browser) = find() {
        return Ok(browser);
    }
    let advice = "name a browser with DDL_BROWSER=/path/to/program";
    debian::ensure_program("chromium", &["chromium", "fonts-dejavu-core"]).context(advice)?;
    find().context("apt-get installed a browser, but it is not on the search path")
}
