//! `cargo xtask docs`: the guide and the interface of every crate, as one site.

use std::ffi::OsStr;
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;

use crate::browser::Browser;
use crate::site;
use crate::workspace::{Workspace, absolute};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Open the first page in a browser
    #[arg(long)]
    open: bool,
    /// Check every page of the guide in a browser, and write screenshots of some to this folder, wide and narrow, light
    /// and dark
    #[arg(long, value_name = "DIR")]
    screenshots: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let first = site::build(workspace)?;
        println!("{}", first.display());
        if let Some(folder) = self.screenshots {
            let folder = absolute(&folder)?;
            let script = workspace.path("tests/page/check_site.py");
            let site = first.parent().context("the site must be in a folder")?;
            let options = [OsStr::new("--screenshots").as_ref(), folder.as_path()];
            Browser::ready()?.run_check(&script, site, options)?;
        }
        if self.open {
            open::that_detached(&first)
                .with_context(|| format!("no browser could be started; open {} yourself", first.display()))?;
        }
        Ok(())
    }
}

pub(super) fn check(workspace: &Workspace) -> Result<()> {
    site::build(workspace).map(drop)
}

#[cfg(test)]
#[path = "../../../tests/src/console.rs"]
mod console;

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser as _;

    #[test]
    fn every_call_of_this_program_in_the_documentation_is_valid() {
        let workspace = Workspace::find().unwrap();
        let mut understood = 0;
        for page in workspace.files().unwrap() {
            if page.extension() != Some(OsStr::new("md")) {
                continue;
            }
            let text = std::fs::read_to_string(workspace.root().join(&page)).unwrap();
            for command in console::commands(&text) {
                let words = command.words().unwrap_or_default();
                if let ["cargo", "xtask", arguments @ ..] | ["./xtask", arguments @ ..] = words.as_slice() {
                    let call = ["cargo xtask"].iter().chain(arguments);
                    if let Err(error) = crate::Arguments::try_parse_from(call) {
                        panic!("{}:{}: {}\n{error}", page.display(), command.line, command.typed);
                    }
                    understood += 1;
                }
            }
        }
        assert!(understood > 10, "only {understood} calls were found");
        assert!(crate::Arguments::try_parse_from(["cargo xtask", "docs", "--none"]).is_err());
    }
}
