//! Unpacks libtorch from pinned wheels, completely or not at all.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};

use super::VERSION;
use crate::cache;
use crate::process::{read, run};
use crate::python::Python;

/// The wheels and their SHA-256 sums, which pip checks.
const REQUIREMENTS: &str = include_str!("../../libtorch.txt");
const UNPACK: &str = include_str!("../python/unpack.py");

/// Python version and platforms of the wheels. The libraries in them do not depend on Python, so any Python 3 can fetch
/// them.
const FOR: [&str; 10] = [
    "--implementation=cp",
    "--python-version=3.11",
    "--platform=manylinux_2_28_x86_64",
    "--platform=manylinux_2_25_x86_64",
    "--platform=manylinux_2_17_x86_64",
    "--platform=manylinux2014_x86_64",
    "--no-deps",
    "--require-hashes",
    "--progress-bar=off",
    "--retries=3",
];

/// What is used from the wheels, `FROM=TO`; a `FROM` that ends in a slash is a tree.
const MEMBERS: [&str; 9] = [
    "torch/include/=include/",
    "torch/lib/libtorch_cpu.so=lib/libtorch_cpu.so",
    "torch/lib/libc10.so=lib/libc10.so",
    "torch/lib/libgomp.so.1=lib/libgomp.so.1",
    "nvidia/cu13/lib/libcudart.so.13=lib/libcudart.so.13",
    "nvidia/cu13/lib/libcupti.so.13=lib/libcupti.so.13",
    "torch-2.11.0.dist-info/licenses/=licenses/torch/",
    "nvidia_cuda_runtime-13.0.96.dist-info/licenses/=licenses/cuda-runtime/",
    "nvidia_cuda_cupti-13.0.85.dist-info/licenses/=licenses/cuda-cupti/",
];

/// Size of the wheels, and disk space of the unpacked libraries (495 MB measured) with a margin, in bytes.
const WHEELS_BYTES: u64 = 543_563_777;
const UNPACKED_BYTES: u64 = 560_000_000;

/// Written last: the list of the wheels. A folder without it is unfinished.
const MARK: &str = ".complete";

/// Whether the folder was finished from the currently pinned wheels. This runs before every build.
pub(super) fn is_complete(folder: &Path) -> bool {
    let mark = fs::read_to_string(folder.join(MARK)).unwrap_or_default();
    let mut sums = REQUIREMENTS
        .split("--hash=sha256:")
        .skip(1)
        .map(|rest| rest.split_whitespace().next());
    sums.all(|sum| sum.is_some_and(|sum| mark.contains(sum)))
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
    let python = Python::find()?;
    cache::fill(folder, is_complete, |work| {
        let (free, needed) = (python.free_space(work)?, WHEELS_BYTES + UNPACKED_BYTES);
        ensure!(
            free >= needed,
            "{} has {} MB free and {} MB are needed: make room, or choose another disk with `cargo xtask setup --cache \
             DIR`",
            work.parent().unwrap_or(work).display(),
            free / 1_000_000,
            needed / 1_000_000
        );
        let wheels = work.join("wheels");
        bring_in(&python, wheel_dir, &wheels)?;
        let unpacked = work.join("libtorch");
        let mut unpack = python.call(["-c", UNPACK]);
        read(unpack.args([&wheels, &unpacked]).args(MEMBERS)).context("the wheels cannot be unpacked")?;
        finish(&unpacked)?;
        Ok(unpacked)
    })
}

/// Brings the pinned wheels into the folder `to`, with their SHA-256 checked.
fn bring_in(python: &Python, wheel_dir: Option<&Path>, to: &Path) -> Result<()> {
    let list = to.with_extension("txt");
    fs::write(&list, REQUIREMENTS).context("a temporary file cannot be written")?;
    let mut pip = python.pip("download");
    pip.args(FOR).arg("--dest").arg(to).arg("--requirement").arg(list);
    if let Some(wheels) = wheel_dir {
        pip.args(["--no-index", "--find-links"]).arg(wheels);
        return run(&mut pip).with_context(|| {
            format!(
                "{} must hold the pinned wheels that docs/libtorch.md lists",
                wheels.display()
            )
        });
    }
    eprintln!(
        "downloading libtorch {VERSION} with pip, {} MB, once",
        WHEELS_BYTES / 1_000_000
    );
    run(&mut pip).with_context(|| {
        format!(
            "pip could not download the wheels (its output is above): connect to a package index, or give the wheels \
             with `cargo xtask setup --wheel-dir DIR`, or an installed libtorch {VERSION} with LIBTORCH=DIR \
             (docs/libtorch.md)"
        )
    })
}

/// Adds the files that the wheels lack, and the completion mark.
fn finish(folder: &Path) -> Result<()> {
    // The binding links `torch`, which in the wheel is a shim that also needs the CUDA libraries.
    #[cfg(unix)]
    std::os::unix::fs::symlink("libtorch_cpu.so", folder.join("lib/libtorch.so"))
        .context("libtorch.so cannot be linked")?;
    // With this file the binding's build script compares the versions itself.
    fs::write(folder.join("build-version"), format!("{VERSION}\n")).context("build-version cannot be written")?;
    fs::write(folder.join(MARK), REQUIREMENTS).context(".complete cannot be written")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_complete_folders_of_the_pinned_wheels_are_trusted() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("lib")).unwrap();
        assert!(!is_complete(folder.path()));
        finish(folder.path()).unwrap();
        assert!(is_complete(folder.path()));
        let of_others = REQUIREMENTS.replace("7aa2f9bb", "00000000");
        for damaged in [&of_others, &REQUIREMENTS[..300]] {
            fs::write(folder.path().join(MARK), damaged).unwrap();
            assert!(!is_complete(folder.path()));
        }
    }

    #[test]
    fn missing_and_wrong_wheels_are_refused_and_nothing_is_left() {
        let cache = tempfile::tempdir().unwrap();
        let wheels = tempfile::tempdir().unwrap();
        let folder = cache.path().join("libtorch");
        for name in [None, Some("torch-2.11.0-cp311-cp311-manylinux_2_28_x86_64.whl")] {
            if let Some(name) = name {
                fs::write(wheels.path().join(name), "half a wheel").unwrap();
            }
            let message = format!("{:#}", fetch(&folder, Some(wheels.path())).unwrap_err());
            assert!(message.contains("must hold the pinned wheels"), "{message}");
            assert_eq!(fs::read_dir(cache.path()).unwrap().count(), 0);
        }
    }
}
