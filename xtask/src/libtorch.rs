//! libtorch: pinned version, location, fetching and cargo configuration. Every command that builds calls [`ensure`]
//! first.

mod config;
mod fetch;
mod locate;

use crate::cache;
use crate::process::find_on_path;
use crate::workspace::{Workspace, absolute};
use anyhow::{Context, Result, bail};
use clap::Args;
use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Version of libtorch that the binding in `Cargo.lock` requires.
pub(crate) const VERSION: &str = "2.11.0";

/// The origin of newly fetched libraries.
pub(crate) const FETCHED: &str = "from the pinned wheels";

#[derive(Debug, Clone, Default, Args)]
pub(crate) struct LibtorchRequest {
    /// Folder with the pinned wheels, for a machine without a package index
    #[arg(long, value_name = "DIR")]
    wheel_dir: Option<PathBuf>,
    /// Folder for the unpacked libraries [default: the user's cache, `~/.cache/ddl`]
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
}

#[derive(Debug, Clone)]
pub(crate) struct Ready {
    pub(crate) folder: PathBuf,
    /// Where it was found: a clause.
    pub(crate) origin: &'static str,
    /// Whether the generated cargo configuration had to be written.
    pub(crate) reconfigured: bool,
}

/// Makes plain `cargo build`, `test`, `run`, `bench` and `doc` work.
pub(crate) fn ensure(workspace: &Workspace, request: &LibtorchRequest) -> Result<Ready> {
    require_compiler()?;
    let generated = workspace.path(config::GENERATED);
    let (folder, origin) = choose(&generated, request)?;
    let reconfigured = config::write(&generated, &folder)?;
    Ok(Ready { folder, origin, reconfigured })
}

fn choose(generated: &Path, request: &LibtorchRequest) -> Result<(PathBuf, &'static str)> {
    let configured = config::read(generated);
    let variable = env::var_os("LIBTORCH").filter(|value| !value.is_empty()).map(PathBuf::from);
    // Cargo passes the configured folder to every program it runs, including this one: only a different value was set
    // by the user.
    if let Some(folder) = variable.filter(|folder| configured.as_ref() != Some(folder)) {
        let folder = absolute(&folder)?;
        if let Err(reason) = locate::validate(&folder) {
            let shown = folder.display();
            bail!("LIBTORCH={shown} cannot be used: {reason}; unset LIBTORCH, or point it to libtorch {VERSION}");
        }
        return Ok((folder, "from the variable LIBTORCH"));
    }
    let asked = request.cache.is_some() || request.wheel_dir.is_some();
    if let Some(folder) = configured.filter(|folder| !asked && locate::validate(folder).is_ok()) {
        return Ok((folder, "as set up before"));
    }
    let kept = match &request.cache {
        Some(folder) => absolute(folder)?,
        None => cache::folder()?,
    };
    let folder = kept.join(format!("libtorch-{VERSION}"));
    if fetch::is_complete(&folder) && locate::validate(&folder).is_ok() {
        return Ok((folder, "from the cache"));
    }
    fetch::fetch(&folder, request.wheel_dir.as_deref())
        .with_context(|| format!("libtorch {VERSION} could not be set up"))?;
    Ok((folder, FETCHED))
}

/// The binding of libtorch is a C++ file: without a compiler the build would fail after minutes.
fn require_compiler() -> Result<()> {
    // CXX may contain a launcher and flags, as in `ccache g++`.
    let compiler = env::var("CXX").unwrap_or_default();
    let program = compiler.split_whitespace().next().unwrap_or("c++");
    if find_on_path(OsStr::new(program)).is_none() {
        bail!("a C++ compiler is missing ({program} is not on the search path): on Debian or Ubuntu `apt install g++`");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The binding's build script fixes the libtorch version that it requires.
    #[test]
    fn the_version_belongs_to_the_locked_binding_and_is_the_one_that_runs_record() {
        let workspace = Workspace::find().unwrap();
        let text = |file: &str| std::fs::read_to_string(workspace.path(file)).unwrap();
        let lock = text("Cargo.lock");
        for binding in ["tch", "torch-sys"] {
            let locked = format!("name = \"{binding}\"\nversion = \"0.24.0\"\n");
            assert!(lock.contains(&locked), "{binding}");
        }
        assert!(text("xtask/libtorch.txt").contains(&format!("torch=={VERSION} ")));
        let recorded = format!("LIBTORCH_VERSION: &str = \"{VERSION}\"");
        assert!(text("crates/ddl-star/src/device.rs").contains(&recorded));
    }
}
