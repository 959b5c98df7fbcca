//! Where a Chromium is, and how to get one where that is possible.

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use anyhow::{Context, Result, bail};

use super::patience::run_within;
use crate::workspace::find_on_path;

/// Programs that are one, the plainest first.
const NAMES: [&str; 5] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
];
/// What is installed where a machine lets us: the browser, and letters for it to write with.
const PACKAGES: [&str; 2] = ["chromium", "fonts-dejavu-core"];
/// A slow mirror is given this time for each of its two steps.
const LIMIT: Duration = Duration::from_mins(10);
/// What to do where we cannot.
const ADVICE: &str = "install Chromium, on Debian with `apt install chromium fonts-dejavu-core`, or name one with \
    DDL_BROWSER=/path/to/program";

/// `$DDL_BROWSER`, or a Chromium on the search path, or one that is installed now.
pub(super) fn find_or_install() -> Result<PathBuf> {
    if let Some(named) = env::var_os("DDL_BROWSER").filter(|value| !value.is_empty()) {
        return named_one(&named);
    }
    if let Some(found) = find(&NAMES) {
        return Ok(found);
    }
    if find_on_path(OsStr::new("apt-get")).is_none() || !is_root() {
        bail!("no browser to check the report page with: {ADVICE}");
    }
    install()?;
    find(&NAMES).with_context(|| {
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

fn find(names: &[&str]) -> Option<PathBuf> {
    names.iter().find_map(|name| find_on_path(OsStr::new(name)))
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
            .args([
                "-q",
                "-o",
                "Acquire::Retries=3",
                "-o",
                "DPkg::Lock::Timeout=120",
            ])
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_named_browser_must_be_there() {
        assert!(named_one(OsStr::new("sh")).unwrap().is_absolute());
        let error = named_one(OsStr::new("/nowhere/chromium"))
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("/nowhere/chromium") && error.contains("apt install"),
            "{error}"
        );
    }

    #[test]
    fn the_first_name_that_is_there_is_taken() {
        assert_eq!(find(&["no-such-browser"]), None);
        let found = find(&["no-such-browser", "sh", "cat"]).unwrap();
        assert_eq!(found.file_name(), Some(OsStr::new("sh")));
    }
}
