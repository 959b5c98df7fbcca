//! `cargo xtask deny`: what may come in from outside, checked with cargo-deny by `deny.toml`.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::libtorch::user_cache;
use crate::workspace::{Workspace, find_on_path};

/// The version that `deny.toml` was written for.
const VERSION: &str = "0.20.2";
/// What needs no network once the dependencies are there. Advisories do: their database changes by the day.
const CHECKS: [&str; 3] = ["bans", "licenses", "sources"];
/// The tool runs for a second: its build is what takes time, two to three minutes on two cores, and is made short.
const BUILD: [(&str, &str); 5] = [
    ("CARGO_PROFILE_RELEASE_OPT_LEVEL", "0"),
    ("CARGO_PROFILE_RELEASE_DEBUG", "false"),
    ("CARGO_PROFILE_RELEASE_LTO", "off"),
    ("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16"),
    ("CARGO_PROFILE_RELEASE_STRIP", "true"),
];

pub(crate) fn run(workspace: &Workspace) -> Result<()> {
    let tool = ensure(workspace)?;
    // The list of dependencies is of every platform, what a build here brought in is not.
    let fetched = workspace
        .cargo_process()
        .args(["fetch", "--locked", "--quiet"])
        .status()
        .context("cargo cannot be started")?;
    if !fetched.success() {
        bail!(
            "`cargo fetch --locked` failed (above): connect to the package index, or run `cargo update --workspace` if Cargo.lock is out of date"
        );
    }
    let status = Command::new(&tool)
        .current_dir(workspace.root())
        .args(["--offline", "--locked", "--all-features", "check"])
        .args(CHECKS)
        .status()
        .with_context(|| format!("{} cannot be started", tool.display()))?;
    if !status.success() {
        bail!(
            "deny.toml forbids a dependency (above): do without it, or say in deny.toml why it may come in"
        );
    }
    Ok(())
}

/// The tool of the pinned version: from the search path, from the user's cache, or built from its sources now.
fn ensure(workspace: &Workspace) -> Result<PathBuf> {
    let installed = find_on_path(OsStr::new("cargo-deny"));
    if let Some(program) = installed.filter(|program| is_pinned(program)) {
        return Ok(program);
    }
    let cache = user_cache()?;
    let folder = cache.join(format!("cargo-deny-{VERSION}"));
    let program = program_in(&folder);
    if !is_pinned(&program) {
        build(workspace, &cache, &folder)?;
    }
    if !is_pinned(&program) {
        bail!(
            "{} does not run: delete {} and try again",
            program.display(),
            folder.display()
        );
    }
    Ok(program)
}

fn program_in(folder: &Path) -> PathBuf {
    folder.join(format!("bin/cargo-deny{}", std::env::consts::EXE_SUFFIX))
}

/// Whether a program says of itself that it is the pinned version.
fn is_pinned(program: &Path) -> bool {
    let output = Command::new(program)
        .arg("--version")
        .stderr(Stdio::null())
        .output();
    output.is_ok_and(|output| {
        output.status.success()
            && output.stdout.trim_ascii() == format!("cargo-deny {VERSION}").as_bytes()
    })
}

/// Everything happens in a temporary folder of the cache; the finished one takes its name at the very end.
fn build(workspace: &Workspace, cache: &Path, folder: &Path) -> Result<()> {
    fs::create_dir_all(cache).with_context(|| format!("{} cannot be created", cache.display()))?;
    let work = tempfile::Builder::new()
        .prefix(".cargo-deny-incoming-")
        .tempdir_in(cache)
        .with_context(|| format!("{} cannot be written to", cache.display()))?;
    eprintln!("cargo-deny {VERSION}: building it, once, for two to three minutes");
    let mut cargo = workspace.cargo_process();
    cargo
        .args(["install", "cargo-deny", "--locked", "--quiet", "--version"])
        .arg(format!("={VERSION}"))
        .arg("--root")
        .arg(work.path().join("tool"))
        .arg("--target-dir")
        .arg(work.path().join("build"))
        .envs(BUILD)
        // The workspace's own configuration, with the path to libtorch, is not for tools.
        .current_dir(work.path());
    let status = cargo.status().context("cargo cannot be started")?;
    if !status.success() {
        bail!(
            "cargo-deny {VERSION} cannot be built (above): connect to the package index, or put a cargo-deny {VERSION} on the \
             search path"
        );
    }
    if folder.exists() {
        fs::rename(folder, work.path().join("replaced"))
            .with_context(|| format!("the damaged {} cannot be replaced", folder.display()))?;
    }
    match fs::rename(work.path().join("tool"), folder) {
        // Somebody else was faster.
        Err(_) if is_pinned(&program_in(folder)) => Ok(()),
        outcome => outcome.with_context(|| format!("{} cannot be created", folder.display())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_pinned_version_is_trusted() {
        let folder = tempfile::tempdir().unwrap();
        assert!(!is_pinned(&program_in(folder.path())));
        assert!(!is_pinned(Path::new("sh")));
    }

    #[cfg(unix)]
    #[test]
    fn a_program_is_known_by_what_it_says() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        for (version, pinned) in [(VERSION, true), ("0.14.2", false)] {
            let program = folder.path().join(version);
            fs::write(&program, format!("#!/bin/sh\necho cargo-deny {version}\n")).unwrap();
            fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
            assert_eq!(is_pinned(&program), pinned, "{version}");
        }
    }
}
