//! Installation of Debian packages that a check needs.

use crate::process::{find_on_path, read, run};
use anyhow::{Context, Result, ensure};
use std::ffi::OsStr;
use std::process::Command;

/// Installs `packages` unless `program` is on the search path. The error names what to install.
pub(crate) fn ensure_program(program: &str, packages: &[&str]) -> Result<()> {
    if find_on_path(OsStr::new(program)).is_some() {
        return Ok(());
    }
    let wanted = packages.join(" ");
    let advice = || format!("{program} is missing: install it, on Debian with `apt install {wanted}`");
    let is_root = read(Command::new("id").arg("-u")).is_ok_and(|user| user.trim() == "0");
    ensure!(is_root && find_on_path(OsStr::new("apt-get")).is_some(), "{}", advice());
    for arguments in [&["update"][..], &[&["install", "-y", "--no-install-recommends"], packages].concat()] {
        let mut command = Command::new("apt-get");
        command
            .args(["-qq", "-o", "Acquire::Retries=3", "-o", "DPkg::Lock::Timeout=120"])
            .args(arguments)
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdout(std::io::stderr());
        run(&mut command).with_context(advice)?;
    }
    Ok(())
}
