//! The Python package that drives the browser, of one pinned version, in the user's cache.
//!
//! It is put into a folder of its own (`pip --target`) and not into a virtual environment: Debian's Python makes none
//! without a further package, and refuses to change what the system has installed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Context, Result};

use super::{LIMIT, run_within};
use crate::libtorch::user_cache;
use crate::python::{self, Python};

/// The version the check was written with.
const REQUIREMENT: &str = "playwright==1.65.2";

/// The folder for Python's search path; the package is fetched when it is not there.
pub(super) fn ensure(python: &Python) -> Result<PathBuf> {
    let cache = user_cache()?;
    let folder = cache.join(folder_name(python)?);
    if !folder.is_dir() {
        fetch(&folder, &cache)?;
    }
    Ok(folder)
}

/// The package is compiled for one minor version of Python.
fn folder_name(python: &Python) -> Result<String> {
    let script = "import sys; print('%s-%d.%d' % (sys.implementation.name, *sys.version_info[:2]))";
    let version = python::read(&mut python.script(script, [] as [&str; 0]))?;
    Ok(format!(
        "{}-{}",
        REQUIREMENT.replace("==", "-"),
        version.trim()
    ))
}

/// Everything happens in a temporary folder beside it, which takes its name at the very end.
fn fetch(folder: &Path, cache: &Path) -> Result<()> {
    let python = Python::with_pip()?;
    fs::create_dir_all(cache).with_context(|| format!("{} cannot be created", cache.display()))?;
    let work = tempfile::Builder::new()
        .prefix(".playwright-incoming-")
        .tempdir_in(cache)
        .with_context(|| format!("{} cannot be written to", cache.display()))?;
    let target = work.path().join("packages");
    eprintln!("{REQUIREMENT}: fetching it with pip, once");
    let mut pip = python.module("pip");
    pip.args([
        "install",
        "--quiet",
        "--only-binary=:all:",
        "--no-cache-dir",
    ])
    .args(["--disable-pip-version-check", "--no-warn-script-location"])
    .args(["--timeout", "60", "--retries", "3", "--target"])
    .arg(&target)
    .arg(REQUIREMENT)
    .stdout(Stdio::from(std::io::stderr()));
    run_within(&mut pip, LIMIT).with_context(|| {
        format!("pip could not fetch {REQUIREMENT}: connect to a package index")
    })?;
    match fs::rename(&target, folder) {
        // Somebody else was faster.
        Err(_) if folder.is_dir() => Ok(()),
        outcome => outcome.with_context(|| format!("{} cannot be created", folder.display())),
    }
}
