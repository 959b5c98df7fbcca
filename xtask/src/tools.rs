//! Programs of others that the checks run: pinned wheels, fetched once per machine into the user's cache.

use crate::cache::{self, sha256};
use crate::process::{read, run};
use crate::python::Python;
use crate::workspace::Workspace;
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Names, versions and SHA-256 sums, for pip: of the checks, and of a release.
const LIST: &str = "xtask/tools.txt";
const LIST_OF_RELEASE: &str = "xtask/release-tools.txt";

/// The folder of the tools, for Python's search path; its `bin` holds the programs.
#[derive(Debug)]
pub(crate) struct Tools {
    folder: PathBuf,
    python: Python,
}

impl Tools {
    /// The tools of the checks, from the cache or from the package index.
    pub(crate) fn ensure(workspace: &Workspace) -> Result<Self> {
        Self::of_list(workspace, LIST)
    }

    /// The tools of a release.
    pub(crate) fn for_release(workspace: &Workspace) -> Result<Self> {
        Self::of_list(workspace, LIST_OF_RELEASE)
    }

    /// The tools of the checks if they were fetched before.
    pub(crate) fn kept(workspace: &Workspace) -> Result<Option<Self>> {
        let Ok(python) = Python::find() else { return Ok(None) };
        let folder = folder(&python, &workspace.path(LIST))?;
        Ok(folder.is_dir().then_some(Self { folder, python }))
    }

    fn of_list(workspace: &Workspace, list: &str) -> Result<Self> {
        let python = Python::find()?;
        let list = workspace.path(list);
        let folder = folder(&python, &list)?;
        if !folder.is_dir() {
            eprintln!("fetching the tools of {} with pip, once", list.display());
            fs::create_dir_all(cache::folder()?)?;
            let work = tempfile::tempdir_in(cache::folder()?)?.keep();
            let pip = "-m pip install --quiet --disable-pip-version-check --only-binary=:all: --no-cache-dir --no-deps \
                       --require-hashes --no-warn-script-location --root-user-action ignore --target";
            let mut pip = python.call(pip.split_whitespace());
            pip.arg(&work).arg("--requirement").arg(&list);
            let outcome = run(pip.stdout(std::io::stderr())).context("connect to a package index");
            // Another process may have been faster.
            if outcome.is_err() || fs::rename(&work, &folder).is_err() {
                fs::remove_dir_all(&work)?;
            }
            outcome?;
        }
        Ok(Self { folder, python })
    }

    /// A program of these, with the environment of a plain cargo.
    pub(crate) fn program(&self, workspace: &Workspace, name: &str) -> Command {
        let mut program = workspace.program(self.folder.join("bin").join(name));
        program.env("PYTHONPATH", &self.folder);
        program
    }

    /// Python with the packages of these.
    pub(crate) fn python(&self, script: &Path) -> Command {
        let mut command = self.python.call([script]);
        command.env("PYTHONPATH", &self.folder).env("PYTHONDONTWRITEBYTECODE", "1");
        command
    }
}

/// Where the tools of a list are: some packages are compiled for one minor version of Python.
fn folder(python: &Python, list: &Path) -> Result<PathBuf> {
    let version = read(&mut python.call(["-c", "import sys; print('%d.%d' % sys.version_info[:2])"]))?;
    Ok(cache::folder()?.join(format!("tools-{}-{}", version.trim(), &sha256(list)?[..12])))
}

/// A cargo subcommand of others that no wheel has, built once per machine into the user's cache.
pub(crate) fn cargo_tool(workspace: &Workspace, name: &str, version: &str) -> Result<PathBuf> {
    let folder = cache::folder()?.join("cargo-tools");
    let mut install = workspace.cargo(["install", name, "--locked", "--quiet", "--version", version, "--root"]);
    // Tools must not use the configuration of the workspace, which has the path to libtorch.
    run(install.arg(&folder).current_dir(std::env::temp_dir()))?;
    Ok(folder.join("bin").join(name))
}
