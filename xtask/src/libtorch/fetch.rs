//! Fetches libtorch as pinned wheels, completely or not at all.

use super::VERSION;
use crate::process::run;
use crate::python::Python;
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::Path;

/// The wheels and their SHA-256 sums, which pip checks.
const REQUIREMENTS: &str = include_str!("../../libtorch.txt");
const SCRIPT: &str = include_str!("../python/libtorch.py");

/// Whether the folder was finished from the currently pinned wheels. This runs before every build.
pub(super) fn is_complete(folder: &Path) -> bool {
    let mark = fs::read_to_string(folder.join(".complete")).unwrap_or_default();
    let sums = REQUIREMENTS.split("--hash=sha256:").skip(1);
    sums.filter_map(|rest| rest.split_whitespace().next()).all(|sum| mark.contains(sum))
}

/// Fills the cache folder from the package index, or from a folder of wheels.
pub(super) fn fetch(folder: &Path, wheel_dir: Option<&Path>) -> Result<()> {
    ensure!(
        cfg!(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu")),
        "there is no pinned libtorch for this platform ({} {}): install libtorch {VERSION} yourself and set LIBTORCH \
         to its folder",
        std::env::consts::OS,
        std::env::consts::ARCH
    );
    eprintln!("fetching libtorch {VERSION} with pip, 543 MB, once");
    let mut script = Python::find()?.call(["-c", SCRIPT]);
    run(script.arg(folder).arg(REQUIREMENTS).args(wheel_dir)).context("the reason is above")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_folders_of_the_pinned_wheels_are_trusted() {
        let folder = tempfile::tempdir().unwrap();
        assert!(!is_complete(folder.path()));
        let of_others = REQUIREMENTS.replace("7aa2f9bb", "00000000");
        for (mark, is_trusted) in [(REQUIREMENTS, true), (&of_others, false), (&REQUIREMENTS[..300], false)] {
            fs::write(folder.path().join(".complete"), mark).unwrap();
            assert_eq!(is_complete(folder.path()), is_trusted);
        }
    }
}
