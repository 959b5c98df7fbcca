//! Finds Chromium, or installs it if possible.

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::debian;
use crate::workspace::find_on_path;

const NAMES: [&str; 5] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
];
/// Packages to install where this is allowed: the browser and a font.
const PACKAGES: [&str; 2] = ["chromium", "fonts-dejavu-core"];
const ADVICE: &str = "install Chromium, on Debian with `apt install chromium fonts-dejavu-core`, or name one with \
    DDL_BROWSER=/path/to/program";

/// `$DDL_BROWSER`, a Chromium on the search path, or a newly installed one.
pub(super) fn find_or_install() -> Result<PathBuf> {
    if let Some(named) = env::var_os("DDL_BROWSER").filter(|value| !value.is_empty()) {
        return named_one(&named);
    }
    let find = || NAMES.iter().find_map(|name| find_on_path(OsStr::new(name)));
    if let Some(found) = find() {
        return Ok(found);
    }
    if !debian::can_install() {
        bail!("no browser was found for the checks of pages: {ADVICE}");
    }
    debian::install(&PACKAGES).context(ADVICE)?;
    find().with_context(|| format!("apt-get installed a browser, but it is not on the search path: {ADVICE}"))
}

fn named_one(named: &OsStr) -> Result<PathBuf> {
    find_on_path(named)
        .with_context(|| format!("DDL_BROWSER={} is not a program: {ADVICE}", Path::new(named).display()))
}
