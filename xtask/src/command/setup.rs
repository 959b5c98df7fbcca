//! `cargo xtask setup`: libtorch, cargo's configuration for it, and the hook of git.

use super::hook;
use crate::libtorch::{self, LibtorchRequest};
use crate::workspace::Workspace;
use anyhow::Result;
use clap::Args;
use std::time::Instant;

#[derive(Debug, Args)]
pub(crate) struct SetupArguments {
    #[command(flatten)]
    request: LibtorchRequest,
    /// Print shell lines that set libtorch's variables, for tools that do not use cargo's configuration:
    /// `eval "$(cargo xtask setup --env)"`
    #[arg(long)]
    env: bool,
}

impl SetupArguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let start = Instant::now();
        let ready = libtorch::ensure(workspace, &self.request)?;
        if self.env {
            let quoted = format!("'{}'", ready.folder.display().to_string().replace('\'', "'\\''"));
            println!("export LIBTORCH={quoted}");
            println!("export LD_LIBRARY_PATH={quoted}/lib${{LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}}");
            return Ok(());
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
        println!("{}", hook::install(workspace)?);
        Ok(())
    }
}
