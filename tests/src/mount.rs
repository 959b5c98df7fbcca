//! File systems that are full or read-only. Only root can mount them, on Linux; otherwise the tests are skipped with a
//! message.

use crate::skip::skip;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A mounted file system, unmounted when dropped.
#[derive(Debug)]
pub struct Mount(PathBuf);

impl Mount {
    /// A file system in memory with this capacity (KiB); `None`, with the reason printed, if this user may not mount.
    pub fn small(folder: &Path, kibibytes: u64) -> Option<Self> {
        let size = format!("size={kibibytes}k");
        mount(&["-t", "tmpfs", "-o", &size, "none"], folder)?;
        Some(Self(folder.to_owned()))
    }

    /// A read-only view of the folder; `None` as for [`small`](Self::small).
    pub fn read_only(folder: &Path) -> Option<Self> {
        let name = folder.to_str().expect("temporary folders have plain names");
        mount(&["--bind", name], folder)?;
        let mounted = Self(folder.to_owned());
        mount(&["-o", "remount,ro,bind"], folder)?;
        Some(mounted)
    }

    /// Changes the size of a small file system.
    pub fn resize(&self, kibibytes: u64) {
        let size = format!("remount,size={kibibytes}k");
        mount(&["-o", &size], &self.0).expect("the file system can be resized");
    }
}

impl Drop for Mount {
    fn drop(&mut self) {
        // A file system that stays mounted is left to the cleanup of temporary folders.
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
    let user = Command::new("id").arg("-u").output();
    if user.is_ok_and(|user| user.stdout == b"0\n") {
        return skip(reason);
    }
    eprintln!("skipped, {reason}");
    None
}
