//! Installation of Debian packages that a test needs.

use std::ffi::OsStr;
use std::process::{Command, Stdio};
use std::time::Duration;

use anyhow::{Context, Result};

use crate::process::run_within;
use crate::workspace::find_on_path;

/// An installation that takes longer is assumed to hang.
const LIMIT: Duration = Duration::from_mins(10);

/// Whether this is Debian or a derivative, and this process may install packages.
pub(crate) fn can_install() -> bool {
    find_on_path(OsStr::new("apt-get")).is_some() && is_root()
}

/// Installs packages, and reports it on standard error.
pub(crate) fn install(packages: &[&str]) -> Result<()> {
    eprintln!("installing {} with apt-get, once", packages.join(" and "));
    let apt = |arguments: &[&str]| {
        let mut command = Command::new("apt-get");
        command
            .args(["-q", "-o", "Acquire::Retries=3"])
            .args(["-o", "DPkg::Lock::Timeout=120"])
            .args(arguments)
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdin(Stdio::null())
            .stdout(Stdio::from(std::io::stderr()));
        run_within(&mut command, LIMIT).with_context(|| format!("`apt-get {}` failed", arguments.join(" ")))
    };
    apt(&["update"])?;
    let install = ["install", "-y", "--no-install-recommends"];
    apt(&[&install[..], packages].concat())
}

fn is_root() -> bool {
    let output = Command::new("id").arg("-u").output();
    output.is_ok_and(|output| output.status.success() && output.stdout.trim_ascii() == b"0")
}
