//! Where a Chromium is, and how to get one where that is possible.

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use super::{LIMIT, run_within};
use crate::workspace::find_on_path;

const NAMES: [&str; 5] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
];
/// What is installed where a machine lets us: the browser, and letters for it to write with.
const PACKAGES: [&str; 2] = ["chromium", "fonts-dejavu-core"];
const ADVICE: &str = "install Chromium, on Debian with `apt install chromium fonts-dejavu-core`, or name one with \
    DDL_BROWSER=/path/to/program";

/// `$DDL_BROWSER`, or a Chromium on the search path, or one that is installed now.
pub(super) fn find_or_install() -> Result<PathBuf> {
    if let Some(named) = env::var_os("DDL_BROWSER").filter(|value| !value.is_empty()) {
        return named_one(&named);
    }
    let find = || NAMES.iter().find_map(|name| find_on_path(OsStr::new(name)));
    if let Some(found) = find() {
        return Ok(found);
    }
    if find_on_path(OsStr::new("apt-get")).is_none() || !is_root() {
        bail!("no browser to check pages with: {ADVICE}");
    }
    install()?;
    find().with_context(|| {
        format!("apt-get installed no browser that is on the search path: {ADVICE}")
    })
}

fn named_one(named: &OsStr) -> Result<PathBuf> {
    find_on_path(named).with_context(|| {
        format!(
            "DDL_BROWSER={} is no program: {ADVICE}",
            Path::new(named).display()
        )
    })
}

fn is_root() -> bool {
    let output = Command::new("id").arg("-u").output();
    output.is_ok_and(|output| output.status.success() && output.stdout.trim_ascii() == b"0")
}

fn install() -> Result<()> {
    eprintln!(
        "no browser here: installing {} with apt-get, once",
        PACKAGES.join(" and ")
    );
    let apt = |arguments: &[&str]| {
        let mut command = Command::new("apt-get");
        command
            .args(["-q", "-o", "Acquire::Retries=3"])
            .args(["-o", "DPkg::Lock::Timeout=120"])
            .args(arguments)
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdin(Stdio::null())
            .stdout(Stdio::from(std::io::stderr()));
        run_within(&mut command, LIMIT)
            .with_context(|| format!("`apt-get {}` failed; {ADVICE}", arguments.join(" ")))
    };
    apt(&["update"])?;
    let install = ["install", "-y", "--no-install-recommends"];
    apt(&[&install[..], &PACKAGES[..]].concat())
}
