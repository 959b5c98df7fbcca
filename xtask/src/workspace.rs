//! The workspace: its location, and calls of its own cargo and git.

use crate::process::read;
use anyhow::{Context, Result};
use std::collections::BTreeSet;
use std::env;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Once;

/// Variables that would replace the configured flags, and so the path to libtorch, or make the build of the binding
/// ignore `LIBTORCH`.
const HARMFUL: &str = "RUSTFLAGS CARGO_ENCODED_RUSTFLAGS RUSTDOCFLAGS CARGO_ENCODED_RUSTDOCFLAGS LIBTORCH_USE_PYTORCH";

/// Prefixes of variables that `cargo run` sets. A second cargo would see a changed environment and rebuild.
const LEAKING_PREFIXES: [&str; 4] = ["CARGO_PKG_", "CARGO_MANIFEST_", "CARGO_BIN_", "CARGO_CRATE_"];

/// Folder of fetched recordings, relative to the workspace root.
pub(crate) const FETCHED: &str = "datasets/eth_ucy";

#[derive(Debug, Clone)]
pub(crate) struct Workspace {
    pub(crate) root: PathBuf,
}

impl Workspace {
    pub(crate) fn find() -> Result<Self> {
        let manifest_dir =
            env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
        let mut folders = manifest_dir.ancestors();
        let root = folders.find(|folder| folder.join("xtask/Cargo.toml").is_file());
        let root = root.with_context(|| {
            format!(
                "no workspace above {}: run this program as `cargo xtask` inside the checkout",
                manifest_dir.display()
            )
        })?;
        Ok(Self::at(root))
    }

    pub(crate) fn at(root: &Path) -> Self {
        Self { root: root.into() }
    }

    pub(crate) fn path(&self, relative: &str) -> PathBuf {
        self.root.join(relative)
    }

    /// A cargo command at the workspace root with the environment of a plain `cargo` call.
    pub(crate) fn cargo(&self, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Command {
        let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut command = self.program(cargo);
        command.args(arguments);
        command
    }

    /// Another program at the workspace root, which may call cargo itself.
    pub(crate) fn program(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.root);
        for name in variables_to_remove() {
            command.env_remove(name);
        }
        command
    }

    /// Files that git tracks or would track: no ignored and no deleted files.
    pub(crate) fn files(&self) -> Result<Vec<PathBuf>> {
        let list = ["ls-files", "-z", "--cached", "--others", "--exclude-standard"];
        let list = read(self.program("git").args(list)).context("the tidy checks need git and a git checkout")?;
        let names: BTreeSet<&str> = list.split('\0').filter(|name| !name.is_empty()).collect();
        Ok(names.into_iter().map(PathBuf::from).filter(|file| self.root.join(file).is_file()).collect())
    }

    /// The folder of the recordings, absolute, because every test runs in its own package's folder.
    pub(crate) fn recordings(&self) -> Result<Option<PathBuf>> {
        if let Some(folder) = env::var_os("DDL_DATASETS").filter(|value| !value.is_empty()) {
            return absolute(Path::new(&folder)).map(Some);
        }
        Ok(Some(self.path(FETCHED)).filter(|folder| folder.is_dir()))
    }
}

/// Variables to remove from a child cargo's environment; warns once about those that the user has set.
fn variables_to_remove() -> Vec<OsString> {
    static WARN: Once = Once::new();
    WARN.call_once(|| {
        for name in HARMFUL.split(' ').filter(|name| env::var_os(name).is_some()) {
            eprintln!(
                "warning: {name} is set, but ignored: it would replace the configured flags and lose the path to \
                 libtorch (docs/libtorch.md)"
            );
        }
    });
    let leaking = env::vars_os().map(|(name, _)| name).filter(|name| {
        name.to_str().is_some_and(|text| LEAKING_PREFIXES.iter().any(|prefix| text.starts_with(prefix)))
    });
    // The generated configuration has the same LIBTORCH. Without the variable, a plain `cargo build` and one started
    // here see the same environment, and nothing is rebuilt.
    HARMFUL.split(' ').chain(["LIBTORCH"]).map(OsString::from).chain(leaking).collect()
}

/// Removes a folder with what is in it, if it is there.
pub(crate) fn remove_folder(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("{} cannot be removed", folder.display()))?;
    }
    Ok(())
}

/// An absolute path is returned unchanged; a relative one is resolved in the folder where the command was started.
pub(crate) fn absolute(path: &Path) -> Result<PathBuf> {
    std::path::absolute(path).with_context(|| format!("{} cannot be made an absolute path", path.display()))
}
