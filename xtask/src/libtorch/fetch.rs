//! Unpacks libtorch from the pinned wheels, completely or not at all.

use std::fs;
use std::path::Path;
use std::process::Stdio;

use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};

use super::pin::{self, VERSION, WHEELS, Wheel};
use crate::cache;
use crate::digest::{Pin, measure};
use crate::python::{self, Python};

/// Written last; a folder without it is unfinished.
const MARK: &str = ".complete";

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Complete {
    libtorch: String,
    /// SHA-256 of the wheels, in their pinned order.
    wheels: Vec<String>,
    libraries: Vec<Library>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Library {
    file: String,
    sha256: String,
    bytes: u64,
}

/// Whether the folder was finished from the currently pinned wheels and still has its libraries, checked by their
/// sizes, because this runs before every build.
pub(super) fn is_complete(folder: &Path) -> bool {
    let Ok(complete) = read_mark(folder) else {
        return false;
    };
    complete.libtorch == VERSION
        && complete.wheels == WHEELS.map(|wheel| wheel.sha256)
        && complete.libraries.iter().all(|library| {
            fs::metadata(folder.join(&library.file)).is_ok_and(|metadata| metadata.len() == library.bytes)
        })
}

/// Hashes the libraries again and compares them with the recorded hashes.
pub(super) fn verify(folder: &Path) -> Result<()> {
    let complete = read_mark(folder).with_context(|| {
        format!(
            "{} was not unpacked by `cargo xtask setup`, so it has no recorded hashes",
            folder.display()
        )
    })?;
    for library in &complete.libraries {
        Pin {
            sha256: &library.sha256,
            bytes: library.bytes,
        }
        .check(&folder.join(&library.file))
        .with_context(|| format!("a library has changed: delete {} and set up again", folder.display()))?;
    }
    Ok(())
}

fn read_mark(folder: &Path) -> Result<Complete> {
    let text = fs::read(folder.join(MARK)).context(".complete cannot be read")?;
    serde_json::from_slice(&text).context(".complete is damaged")
}

pub(super) fn fetch(folder: &Path, wheel_dir: Option<&Path>) -> Result<()> {
    if !pin::is_supported() {
        bail!(
            "there is no pinned libtorch for this platform ({} {}): install libtorch {VERSION} \
             yourself and set LIBTORCH to its folder",
            std::env::consts::OS,
            std::env::consts::ARCH
        );
    }
    let python = if wheel_dir.is_some() {
        Python::find()?
    } else {
        Python::with_pip()?
    };
    cache::fill(folder, is_complete, |work| {
        require_space(&python, work.parent().unwrap_or(work), wheel_dir.is_none())?;
        let downloads = work.join("wheels");
        if wheel_dir.is_none() {
            download(&python, &downloads)?;
        }
        let laid_out = work.join("libtorch");
        fs::create_dir(&laid_out).context("a temporary folder cannot be created")?;
        for wheel in &WHEELS {
            lay_out(&python, wheel, wheel_dir.unwrap_or(&downloads), &laid_out)?;
        }
        finish(&laid_out)?;
        Ok(laid_out)
    })
}

fn require_space(python: &Python, folder: &Path, downloading: bool) -> Result<()> {
    let wheels: u64 = WHEELS.iter().map(|wheel| wheel.bytes).sum();
    let needed = pin::LAID_OUT_BYTES + if downloading { wheels } else { 0 };
    let free = python.free_space(folder)?;
    if free < needed {
        bail!(
            "{} has {} MB free and {} MB are needed: make room, or choose another disk with \
             `cargo xtask setup --cache DIR`",
            folder.display(),
            free / 1_000_000,
            needed / 1_000_000
        );
    }
    Ok(())
}

fn download(python: &Python, folder: &Path) -> Result<()> {
    let megabytes = WHEELS.iter().map(|wheel| wheel.bytes).sum::<u64>() / 1_000_000;
    eprintln!("downloading libtorch {VERSION} with pip, {megabytes} MB, once");
    let mut pip = python.module("pip");
    pip.args(["download", "--no-deps", "--only-binary=:all:", "--no-cache-dir"])
        .args(["--disable-pip-version-check", "--implementation", "cp"])
        .args(["--python-version", pin::PYTHON_VERSION])
        .args(pin::PLATFORMS.iter().flat_map(|platform| ["--platform", platform]))
        .arg("--dest")
        .arg(folder)
        .args(WHEELS.iter().map(|wheel| wheel.requirement))
        // Standard output may be a report or evaluated by a shell, so pip writes to standard error.
        .stdout(Stdio::from(std::io::stderr()));
    let status = pip.status().context("pip cannot be started")?;
    if !status.success() {
        bail!(
            "pip could not download the wheels (its output is above): connect to a package \
             index, or give the wheels with `cargo xtask setup --wheel-dir DIR`, or an installed \
             libtorch {VERSION} with LIBTORCH=DIR (docs/libtorch.md){}",
            installed_hint(python)
        );
    }
    Ok(())
}

/// Names an installed PyTorch of the right version, found without importing it.
fn installed_hint(python: &Python) -> String {
    let script = "import importlib.util as u; print(u.find_spec('torch').submodule_search_locations[0])";
    python::read(&mut python.script(script, [] as [&str; 0]))
        .ok()
        .map(|text| text.trim().to_owned())
        .filter(|folder| super::locate::validate(Path::new(folder)).is_ok())
        .map(|folder| format!("; Python has one installed: LIBTORCH={folder}"))
        .unwrap_or_default()
}

fn lay_out(python: &Python, wheel: &Wheel, wheels: &Path, target: &Path) -> Result<()> {
    let file = wheels.join(wheel.file);
    if !file.is_file() {
        bail!(
            "{} is missing: the folder must contain the pinned wheels {}",
            file.display(),
            WHEELS.map(|wheel| wheel.file).join(", ")
        );
    }
    Pin {
        sha256: wheel.sha256,
        bytes: wheel.bytes,
    }
    .check(&file)
    .context("a wheel is not the pinned one (delete it and try again)")?;
    let mut script = python.script(python::EXTRACT_ZIP, [file.as_path(), target]);
    script.args(wheel.members);
    python::read(&mut script).with_context(|| format!("{} cannot be unpacked", file.display()))?;
    Ok(())
}

/// Adds the files that the wheels lack, and the completion mark.
fn finish(folder: &Path) -> Result<()> {
    // The binding links `torch`, which in the wheel is a shim that also needs the CUDA libraries.
    #[cfg(unix)]
    std::os::unix::fs::symlink("libtorch_cpu.so", folder.join("lib/libtorch.so"))
        .context("libtorch.so cannot be linked")?;
    // With this file the binding's build script compares the versions itself.
    fs::write(folder.join("build-version"), format!("{VERSION}\n")).context("build-version cannot be written")?;
    let mut libraries = Vec::new();
    for rule in WHEELS.iter().flat_map(|wheel| wheel.members) {
        if let Some((_, file)) = rule.split_once('=').filter(|(_, to)| to.starts_with("lib/")) {
            let (sha256, bytes) = measure(&folder.join(file))?;
            libraries.push(Library {
                file: file.to_owned(),
                sha256,
                bytes,
            });
        }
    }
    let complete = Complete {
        libtorch: VERSION.to_owned(),
        wheels: WHEELS.map(|wheel| wheel.sha256.to_owned()).to_vec(),
        libraries,
    };
    let text = serde_json::to_string_pretty(&complete).context(".complete cannot be written")?;
    fs::write(folder.join(MARK), text).context(".complete cannot be written")
}

#[cfg(test)]
#[path = "fetch_tests.rs"]
mod tests;
