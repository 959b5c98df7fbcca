//! The pinned version of the Python package that drives the browser, in a folder of the user's cache. It is installed
//! with `pip --target`, because Debian's Python needs a further package to create a virtual environment.

use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Context, Result};

use super::LIMIT;
use crate::cache;
use crate::process::run_within;
use crate::python::{self, Python};

const REQUIREMENT: &str = "playwright==1.65.2";

/// The folder for Python's search path; the package is fetched if it is missing.
pub(super) fn ensure(python: &Python) -> Result<PathBuf> {
    let folder = cache::folder()?.join(folder_name(python)?);
    if !folder.is_dir() {
        cache::fill(&folder, Path::is_dir, fetch)?;
    }
    Ok(folder)
}

/// The package is compiled for one minor version of Python.
fn folder_name(python: &Python) -> Result<String> {
    let script = "import sys; print('%s-%d.%d' % (sys.implementation.name, *sys.version_info[:2]))";
    let version = python::read(&mut python.script(script, [] as [&str; 0]))?;
    Ok(format!("{}-{}", REQUIREMENT.replace("==", "-"), version.trim()))
}

fn fetch(work: &Path) -> Result<PathBuf> {
    let python = Python::with_pip()?;
    let target = work.join("packages");
    eprintln!("fetching {REQUIREMENT} with pip, once");
    let mut pip = python.module("pip");
    pip.args(["install", "--quiet", "--only-binary=:all:", "--no-cache-dir"])
        .args(["--disable-pip-version-check", "--no-warn-script-location"])
        .args(["--timeout", "60", "--retries", "3", "--target"])
        .arg(&target)
        .arg(REQUIREMENT)
        .stdout(Stdio::from(std::io::stderr()));
    run_within(&mut pip, LIMIT)
        .with_context(|| format!("pip could not fetch {REQUIREMENT}: connect to a package index"))?;
    Ok(target)
}
