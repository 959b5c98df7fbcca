//! The documentation site: the guide, made by mdBook, and the interface of every crate, made by rustdoc.
//!
//! Everything lies in one folder that can be opened from the file system or served as it is; nothing in it is loaded
//! from a network. The guide brings in the pages of `docs/` whole, so that no sentence is kept twice.

mod api;
mod check;
#[cfg(test)]
mod console;
#[cfg(test)]
mod console_tests;
mod guide;
mod html;
mod landing;
mod links;
mod mdbook;

pub(crate) use api::make_room;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::workspace::Workspace;

/// Where the site goes.
const SITE: &str = "target/site";
/// Where the guide is put together for the renderer.
const STAGE: &str = "target/site-stage";

/// Makes the whole site and checks every link in it; returns its first page.
pub(crate) fn build(workspace: &Workspace) -> Result<PathBuf> {
    let mdbook = mdbook::TOOL.ensure(workspace)?;
    let site = workspace.path(SITE);
    empty(&site)?;
    let libraries = api::libraries(workspace)?;
    let interface = site.join("api");
    api::build(workspace, &interface)?;
    let stage = workspace.path(STAGE);
    empty(&stage)?;
    let shown = guide::stage(workspace, &stage, &libraries)?;
    api::lead_to_guide(&interface, &libraries, &shown)?;
    mdbook::render(&mdbook, &stage, &site.join("guide"))?;
    landing::write(workspace, &site, &libraries)?;
    let counts = check::check(&site)?;
    if !counts.faults.is_empty() {
        let shown: Vec<&str> = counts.faults.iter().take(40).map(String::as_str).collect();
        bail!(
            "{} links of the site lead nowhere:\n{}",
            counts.faults.len(),
            shown.join("\n")
        );
    }
    println!(
        "{} pages, {} links inside the site, all of which lead somewhere",
        counts.pages, counts.links
    );
    Ok(site.join("index.html"))
}

/// An empty folder, whatever was there.
fn empty(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder)
            .with_context(|| format!("{} cannot be emptied", folder.display()))?;
    }
    fs::create_dir_all(folder).with_context(|| format!("{} cannot be made", folder.display()))
}
