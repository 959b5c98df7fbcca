//! File systems that are full or may not be written to. Linux mounts them for root alone; elsewhere the tests say so.

use crate::skip::skip;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Something mounted on a folder, taken off again when dropped.
#[derive(Debug)]
pub struct Mount(PathBuf);

impl Mount {
    /// A file system in memory that holds so many kibibytes; `None`, with the reason printed, where this user may mount nothing.
    pub fn small(folder: &Path, kibibytes: u64) -> Option<Self> {
        let size = format!("size={kibibytes}k");
        mount(&["-t", "tmpfs", "-o", &size, "none"], folder)?;
        Some(Self(folder.to_owned()))
    }

    /// The folder as it is, but not to be written to; otherwise as [`small`](Self::small).
    pub fn read_only(folder: &Path) -> Option<Self> {
        let name = folder.to_str().expect("temporary folders have plain names");
        mount(&["--bind", name], folder)?;
        let mounted = Self(folder.to_owned());
        mount(&["-o", "remount,ro,bind"], folder)?;
        Some(mounted)
    }

    /// Gives a small file system another size.
    pub fn resize(&self, kibibytes: u64) {
        let size = format!("remount,size={kibibytes}k");
        mount(&["-o", &size], &self.0).expect("what was mounted can be resized");
    }
}

impl Drop for Mount {
    fn drop(&mut self) {
        // What is left mounted is left to whoever looks after temporary folders.
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

fn mount(arguments: &[&str], folder: &Path) -> Option<()> {
    let output = Command::new("mount").args(arguments).arg(folder).output();
    let reason = match output {
        Ok(output) if output.status.success() => return Some(()),
        Ok(output) => String::from_utf8_lossy(&output.stderr).trim().to_owned(),
        Err(error) => error.to_string(),
    };
    let reason = format!("nothing can be mounted: {reason}");
    if is_root() {
        return skip(reason);
    }
    eprintln!("skipped, {reason}");
    None
}

fn is_root() -> bool {
    let output = Command::new("id").arg("-u").output();
    output.is_ok_and(|output| output.stdout == b"0\n")
}
