//! The workspace: its location, and calls of its own cargo and git.

use std::collections::BTreeSet;
use std::env;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Once;

use anyhow::{Context, Result, bail};
use serde_json::Value;
use xshell::{Cmd, Shell};

/// Variables that would replace the configured flags, and so the path to libtorch, or make the build of the binding
/// ignore `LIBTORCH`.
const HARMFUL: [&str; 5] = [
    "RUSTFLAGS",
    "CARGO_ENCODED_RUSTFLAGS",
    "RUSTDOCFLAGS",
    "CARGO_ENCODED_RUSTDOCFLAGS",
    "LIBTORCH_USE_PYTORCH",
];

/// Prefixes of variables that `cargo run` sets. A second cargo would see a changed environment and rebuild.
const LEAKING_PREFIXES: [&str; 4] = ["CARGO_PKG_", "CARGO_MANIFEST_", "CARGO_BIN_", "CARGO_CRATE_"];

#[derive(Debug, Clone)]
pub(crate) struct Workspace {
    root: PathBuf,
    shell: Shell,
}

impl Workspace {
    pub(crate) fn find() -> Result<Self> {
        let manifest_dir =
            env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
        let root = manifest_dir
            .ancestors()
            .find(|folder| folder.join("xtask/Cargo.toml").is_file())
            .with_context(|| {
                format!(
                    "no workspace above {}: run this program as `cargo xtask` inside the checkout",
                    manifest_dir.display()
                )
            })?;
        Self::at(root)
    }

    pub(crate) fn at(root: &Path) -> Result<Self> {
        let shell = Shell::new().context("the current folder cannot be read")?;
        shell.change_dir(root);
        Ok(Self {
            root: root.to_path_buf(),
            shell,
        })
    }

    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    pub(crate) fn path(&self, relative: &str) -> PathBuf {
        self.root.join(relative)
    }

    /// A cargo command at the workspace root with the environment of a plain `cargo` call.
    pub(crate) fn cargo<I>(&self, arguments: I) -> Cmd<'_>
    where
        I: IntoIterator,
        I::Item: AsRef<OsStr>,
    {
        let mut command = self.shell.cmd(cargo_program()).args(arguments);
        for name in variables_to_remove() {
            command = command.env_remove(name);
        }
        command
    }

    /// Another program at the workspace root that calls cargo itself.
    pub(crate) fn program(&self, path: &Path) -> Cmd<'_> {
        let mut command = self.shell.cmd(path);
        for name in variables_to_remove() {
            command = command.env_remove(name);
        }
        command
    }

    /// As [`Workspace::cargo`], for callers that need pipes.
    pub(crate) fn cargo_process(&self) -> Command {
        let mut command = Command::new(cargo_program());
        command.current_dir(&self.root);
        for name in variables_to_remove() {
            command.env_remove(name);
        }
        command
    }

    pub(crate) fn metadata(&self) -> Result<Value> {
        let text = self
            .cargo(["metadata", "--no-deps", "--format-version", "1"])
            .quiet()
            .ignore_stderr()
            .read()
            .context("`cargo metadata` failed: is every Cargo.toml well formed?")?;
        serde_json::from_str(&text).context("`cargo metadata` did not print JSON")
    }

    /// Files that git tracks or would track: no ignored and no deleted files.
    pub(crate) fn files(&self) -> Result<Vec<PathBuf>> {
        let list = self
            .shell
            .cmd("git")
            .args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"])
            .quiet()
            .read()
            .context("`git ls-files` failed: the tidy checks need git and a git checkout")?;
        let unique: BTreeSet<PathBuf> = list
            .split('\0')
            .filter(|name| !name.is_empty())
            .map(PathBuf::from)
            .collect();
        Ok(unique
            .into_iter()
            .filter(|file| self.root.join(file).symlink_metadata().is_ok())
            .collect())
    }

    /// The checked-out commit, with `-dirty` if files differ; `unknown` without git.
    pub(crate) fn commit(&self) -> String {
        self.shell
            .cmd("git")
            .args(["describe", "--always", "--dirty", "--abbrev=12", "--exclude", "*"])
            .quiet()
            .ignore_stderr()
            .read()
            .ok()
            .filter(|commit| !commit.is_empty())
            .unwrap_or_else(|| "unknown".to_owned())
    }

    /// The current time in UTC, such as `2024-05-13 09:30 UTC`.
    pub(crate) fn now(&self) -> String {
        self.shell
            .cmd("date")
            .args(["-u", "+%Y-%m-%d %H:%M UTC"])
            .quiet()
            .read()
            .unwrap_or_else(|_| "unknown".to_owned())
    }
}

fn cargo_program() -> OsString {
    env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// Variables to remove from a child cargo's environment; warns once about those that the user has set.
fn variables_to_remove() -> Vec<OsString> {
    static WARN: Once = Once::new();
    WARN.call_once(|| {
        for name in HARMFUL.iter().filter(|name| env::var_os(name).is_some()) {
            eprintln!(
                "warning: {name} is set, but ignored: it would replace the configured \
                 flags and lose the path to libtorch (docs/libtorch.md)"
            );
        }
    });
    let leaking = env::vars_os().map(|(name, _)| name).filter(|name| {
        name.to_str()
            .is_some_and(|text| LEAKING_PREFIXES.iter().any(|prefix| text.starts_with(prefix)))
    });
    HARMFUL
        .iter()
        // The generated configuration has the same value. Without the variable, a plain `cargo build` and one started
        // here see the same environment, and nothing is rebuilt.
        .chain(&["LIBTORCH"])
        .map(OsString::from)
        .chain(leaking)
        .collect()
}

/// Whether `name` is a program on the search path (or a path to one).
pub(crate) fn program_on_path(name: &OsStr) -> bool {
    find_on_path(name).is_some()
}

/// The program of this name on the search path (or the path itself, if it is one).
pub(crate) fn find_on_path(name: &OsStr) -> Option<PathBuf> {
    let direct = Path::new(name);
    if direct.components().count() > 1 {
        return direct.is_file().then(|| direct.to_path_buf());
    }
    let path = env::var_os("PATH")?;
    env::split_paths(&path)
        .map(|folder| folder.join(name))
        .find(|program| program.is_file())
}

/// Runs a command of the workspace. A failure names the step.
pub(crate) fn step(name: &str, command: &Cmd<'_>) -> Result<()> {
    if let Err(error) = command.run() {
        bail!("{name} failed: {error}");
    }
    Ok(())
}

/// An absolute path is returned unchanged; a relative one is resolved in the folder where the command was started.
pub(crate) fn absolute(path: &Path) -> Result<PathBuf> {
    std::path::absolute(path).with_context(|| format!("{} cannot be made an absolute path", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_child_never_sees_libtorch_or_flags() {
        let removed = variables_to_remove();
        for name in HARMFUL.iter().chain(&["LIBTORCH"]) {
            assert!(removed.contains(&OsString::from(name)), "{name}");
        }
    }
}
