//! `cargo xtask setup`: libtorch, and cargo's configuration for it.

use std::path::{Path, PathBuf};
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
    /// Print shell lines that set libtorch's variables, for tools that do not use cargo's configuration:
    /// `eval "$(cargo xtask setup --env)"`
    #[arg(long)]
    env: bool,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let start = Instant::now();
        let request = Request {
            cache: self.cache,
            wheel_dir: self.wheel_dir,
        };
        let ready = libtorch::ensure(workspace, &request)?;
        if self.env {
            return print_environment(&ready.folder);
        }
        println!(
            "libtorch {}: {} ({}), {:.1} s",
            libtorch::VERSION,
            ready.folder.display(),
            ready.origin,
            start.elapsed().as_secs_f64()
        );
        let written = if ready.reconfigured { "written" } else { "up to date" };
        println!("cargo configuration: .cargo/config.generated.toml {written}");
        Ok(())
    }
}

fn print_environment(libtorch: &Path) -> Result<()> {
    let folder = libtorch.to_str().context("libtorch's path is not valid Unicode")?;
    let quoted = format!("'{}'", folder.replace('\'', "'\\''"));
    println!("export LIBTORCH={quoted}");
    println!("export LD_LIBRARY_PATH={quoted}/lib${{LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}}");
    Ok(())
}
