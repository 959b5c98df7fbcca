//! `cargo xtask page`: the report page of the simulated crowds, checked in a browser.

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::Args;

use crate::browser::Browser;
use crate::workspace::{Workspace, absolute, step};

/// Destination of the page, and of screenshots of it.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Folder for the page, its figures and its data
    #[arg(long, value_name = "DIR", default_value = "target/report-page")]
    out: PathBuf,
    /// Folder for screenshots of the whole page, wide and narrow, light and dark
    #[arg(long, value_name = "DIR")]
    screenshots: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let out = workspace.root().join(&self.out);
        let screenshots = self.screenshots.as_deref().map(absolute).transpose()?;
        make_and_check(workspace, &out, screenshots.as_deref())
    }
}

pub(crate) fn check(workspace: &Workspace) -> Result<()> {
    make_and_check(workspace, &workspace.path("target/report-page"), None)
}

fn make_and_check(workspace: &Workspace, out: &Path, screenshots: Option<&Path>) -> Result<()> {
    let browser = Browser::ready()?;
    let build = ["run", "--quiet", "-p", "ddl-report", "--example", "report_page", "--"];
    step("the example `report_page`", &workspace.cargo(build).arg(out))?;
    let script = workspace.path("tests/page/check_page.py");
    let pictures = screenshots.map(|folder| [Path::new("--screenshots"), folder]);
    browser.run_check(&script, out, pictures.into_iter().flatten())?;
    println!("{}", out.join("page.html").display());
    Ok(())
}
