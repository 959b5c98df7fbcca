//! `cargo xtask docs`: the guide and the interface of every crate, as one site.

use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use clap::Args;

use super::set_up;
use crate::browser::Browser;
use crate::site;
use crate::workspace::{Workspace, absolute, find_on_path};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Show the first page in a browser
    #[arg(long)]
    open: bool,
    /// Look at every page of the guide in a browser, and keep pictures of some in this folder, wide and narrow, light
    /// and dark
    #[arg(long, value_name = "DIR")]
    screenshots: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        set_up(workspace)?;
        let first = site::build(workspace)?;
        println!("{}", first.display());
        if let Some(folder) = self.screenshots {
            let folder = absolute(&folder)?;
            let script = workspace.path("tests/page/check_site.py");
            let site = first.parent().context("the site has a folder")?;
            let options = [OsStr::new("--screenshots").as_ref(), folder.as_path()];
            Browser::ready()?.run_check(&script, site, options)?;
        }
        if self.open {
            open(&first)?;
        }
        Ok(())
    }
}

/// As `cargo xtask docs` without arguments.
pub(super) fn check(workspace: &Workspace) -> Result<()> {
    site::build(workspace).map(drop)
}

/// Programs that show a file in the user's browser, by system.
const OPENERS: [&str; 3] = ["xdg-open", "open", "explorer"];

fn open(page: &std::path::Path) -> Result<()> {
    let Some(program) = OPENERS
        .iter()
        .find_map(|name| find_on_path(OsStr::new(name)))
    else {
        bail!(
            "no program here opens a browser: open {} yourself",
            page.display()
        );
    };
    Command::new(&program)
        .arg(page)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .with_context(|| format!("{} cannot be started", program.display()))?;
    Ok(())
}
