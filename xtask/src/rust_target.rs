//! The standard library of a target other than this machine: rustup's, or one that is built from Debian's sources.

use crate::debian;
use crate::process::{find_on_path, read, run};
use crate::workspace::Workspace;
use anyhow::{Context, Result};
use std::env;
use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::process::Command;

/// Debian's compiler, its sources of the standard library, and the packages of both.
const COMPILER: &str = "/usr/bin/rustc";
const SOURCES: &str = "/usr/lib/rustlib/src/rust/library/Cargo.lock";
const PACKAGES: [&str; 2] = ["rustc-web", "rust-web-src"];

/// Lets a command that calls cargo for the target find its standard library, which is installed if it is missing.
pub(crate) fn prepare(workspace: &Workspace, target: &str, command: &mut Command) -> Result<()> {
    let rustup = || run(workspace.program("rustup").args(["--quiet", "target", "add", target]));
    if find_on_path(OsStr::new("rustup")).is_some() && rustup().is_ok() {
        return Ok(());
    }
    let packages = PACKAGES.join(" and ");
    eprintln!("the standard library of {target} is built from Debian's {packages}");
    debian::ensure_program(SOURCES, &PACKAGES)
        .with_context(|| format!("the target {target} needs `rustup target add {target}`"))?;
    // Debian's compiler is a stable one, which builds a standard library only if it is told to.
    command
        .env("CARGO_UNSTABLE_BUILD_STD", "std,panic_abort")
        .env("RUSTC", COMPILER)
        .env("RUSTC_BOOTSTRAP", "1")
        .env("PATH", with_linker(workspace)?);
    Ok(())
}

/// The search path with the linker of the other compiler, which Debian's lacks.
fn with_linker(workspace: &Workspace) -> Result<OsString> {
    let libraries = read(workspace.program("rustc").args(["--print", "target-libdir"]))?;
    let programs = Path::new(libraries.trim()).with_file_name("bin");
    let path = env::var_os("PATH").unwrap_or_default();
    Ok(env::join_paths([programs].into_iter().chain(env::split_paths(&path)))?)
}
