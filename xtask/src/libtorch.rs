//! libtorch: pinned version, location, fetching and cargo configuration. Every command that builds calls [`ensure`]
//! first.

mod config;
mod fetch;
mod locate;
mod pin;

use std::env;
use std::ffi::OsStr;
use std::fmt;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

pub(crate) use pin::VERSION;

use crate::cache;
use crate::workspace::{Workspace, absolute, program_on_path};

#[derive(Debug, Clone, Default)]
pub(crate) struct Request {
    pub(crate) cache: Option<PathBuf>,
    /// Folder with the pinned wheels, for machines without a package index.
    pub(crate) wheel_dir: Option<PathBuf>,
    pub(crate) verify: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Origin {
    Variable,
    /// An earlier set-up, read from the generated configuration.
    Configured,
    /// The folder of unpacked libraries, filled earlier.
    Cache,
    /// The pinned wheels, fetched now.
    Fetched,
}

impl fmt::Display for Origin {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Variable => "from the variable LIBTORCH",
            Self::Configured => "as set up before",
            Self::Cache => "from the cache",
            Self::Fetched => "from the pinned wheels",
        })
    }
}

#[derive(Debug, Clone)]
pub(crate) struct Ready {
    pub(crate) folder: PathBuf,
    pub(crate) origin: Origin,
    /// Whether the generated cargo configuration had to be written.
    pub(crate) reconfigured: bool,
}

/// Makes plain `cargo build`, `test`, `run`, `bench` and `doc` work.
pub(crate) fn ensure(workspace: &Workspace, request: &Request) -> Result<Ready> {
    require_compiler()?;
    let generated = workspace.path(config::GENERATED);
    let (folder, origin) = choose(&generated, request)?;
    if request.verify {
        fetch::verify(&folder)?;
    }
    let reconfigured = config::write(&generated, &folder)?;
    Ok(Ready {
        folder,
        origin,
        reconfigured,
    })
}

fn choose(generated: &Path, request: &Request) -> Result<(PathBuf, Origin)> {
    let configured = config::read(generated);
    let variable = env::var_os("LIBTORCH")
        .filter(|value| !value.is_empty())
        .map(PathBuf::from);
    // Cargo passes the configured folder to every program it runs, including this one: only a different value was set
    // by the user.
    if let Some(folder) = variable.filter(|folder| configured.as_ref() != Some(folder)) {
        let folder = absolute(&folder)?;
        if let Err(reason) = locate::validate(&folder) {
            bail!(
                "LIBTORCH={} cannot be used: {reason}; unset LIBTORCH, or point it to libtorch \
                 {VERSION}",
                folder.display()
            );
        }
        return Ok((folder, Origin::Variable));
    }
    let asked = request.cache.is_some() || request.wheel_dir.is_some();
    if let Some(folder) = configured.filter(|folder| !asked && locate::validate(folder).is_ok()) {
        return Ok((folder, Origin::Configured));
    }
    let kept = match &request.cache {
        Some(folder) => absolute(folder)?,
        None => cache::folder()?,
    };
    let folder = kept.join(pin::folder_name());
    if fetch::is_complete(&folder) && locate::validate(&folder).is_ok() {
        return Ok((folder, Origin::Cache));
    }
    fetch::fetch(&folder, request.wheel_dir.as_deref())
        .with_context(|| format!("libtorch {VERSION} could not be set up"))?;
    Ok((folder, Origin::Fetched))
}

/// The binding of libtorch is a C++ file: without a compiler the build would fail after minutes.
fn require_compiler() -> Result<()> {
    let compiler = env::var_os("CXX").filter(|value| !value.is_empty());
    // CXX may contain a launcher and flags, as in `ccache g++`.
    let program = compiler
        .as_deref()
        .and_then(OsStr::to_str)
        .map_or("c++", |text| text.split_whitespace().next().unwrap_or("c++"));
    if !program_on_path(OsStr::new(program)) {
        bail!(
            "a C++ compiler is missing ({program} is not on the search path): install one, on \
             Debian or Ubuntu with `apt install g++`"
        );
    }
    Ok(())
}
