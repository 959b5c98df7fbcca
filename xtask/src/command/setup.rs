//! `cargo xtask setup` and `cargo xtask env`.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, Result};
use clap::Args;

use crate::libtorch::{self, Request};
use crate::workspace::Workspace;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Folder with the pinned wheels, for a machine without a package index
    #[arg(long, value_name = "DIR")]
    wheel_dir: Option<PathBuf>,
    /// Folder for the unpacked libraries [default: the user's cache, `~/.cache/ddl`]
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Hash the libraries again
    #[arg(long)]
    verify: bool,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let start = Instant::now();
        let request = Request {
            cache: self.cache,
            wheel_dir: self.wheel_dir,
            verify: self.verify,
        };
        let ready = libtorch::ensure(workspace, &request)?;
        println!(
            "libtorch {}: {} ({}{}), {:.1} s",
            libtorch::VERSION,
            ready.folder.display(),
            ready.origin,
            if self.verify { ", hashes verified" } else { "" },
            start.elapsed().as_secs_f64()
        );
        let written = if ready.reconfigured { "written" } else { "up to date" };
        println!("cargo configuration: .cargo/config.generated.toml {written}");
        Ok(())
    }
}

/// Prints `export` lines for a shell: `eval "$(cargo xtask env)"`.
pub(crate) fn print_environment(workspace: &Workspace) -> Result<()> {
    let ready = libtorch::ensure(workspace, &Request::default())?;
    let folder = ready.folder.to_str().context("libtorch's path is not valid Unicode")?;
    let quoted = format!("'{}'", folder.replace('\'', "'\\''"));
    println!("export LIBTORCH={quoted}");
    println!("export LD_LIBRARY_PATH={quoted}/lib${{LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}}");
    Ok(())
}
