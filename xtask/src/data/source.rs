//! Fetching of files from the sources of the manifest.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::process::Stdio;

use anyhow::{Context, Result, bail};
use serde::Deserialize;

use super::manifest::{PinnedFile, Source};
use crate::digest::Pin;
use crate::python::{self, Python};

/// Time limit for the answer of a host, in seconds.
const PATIENCE: &str = "10";

/// Puts the files into a folder, each complete and right or not at all.
pub(super) fn get(python: &Python, source: &Source, files: &[&PinnedFile], folder: &Path) -> Result<()> {
    match source {
        Source::Address { address, .. } => {
            for file in files {
                let address = address.replace("{path}", &file.path);
                download(python, &address, "", file.pin(), &folder.join(&file.name))
                    .with_context(|| file.name.clone())?;
            }
            Ok(())
        }
        Source::Package {
            package,
            archive,
            bytes,
            sha256,
            member,
            ..
        } => {
            let work = tempfile::tempdir().context("no temporary folder can be made")?;
            let path = work.path().join(archive);
            let link = find_on_index(python, package, archive)?;
            download(
                python,
                &link.address,
                &link.authorities,
                Pin { sha256, bytes: *bytes },
                &path,
            )
            .with_context(|| archive.clone())?;
            unpack(python, &path, member, files, folder)
        }
    }
}

#[derive(Debug, Deserialize)]
struct Link {
    address: String,
    /// Certificate bundle that pip is configured with, or empty.
    authorities: String,
}

fn find_on_index(python: &Python, package: &str, archive: &str) -> Result<Link> {
    let mut script = python.script(python::INDEX_LINK, [package, archive]);
    let text = python::read(&mut script).with_context(|| format!("{package} was not found on pip's package index"))?;
    serde_json::from_str(&text).context("the index script did not print a link")
}

fn download(python: &Python, address: &str, authorities: &str, pin: Pin<'_>, path: &Path) -> Result<()> {
    let mut child = python
        .script(python::DOWNLOAD, [address, PATIENCE, authorities])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .context("Python cannot be started")?;
    let stdout = child.stdout.take().context("Python has no output")?;
    let mut bytes = Watched {
        inner: stdout,
        ended: false,
    };
    let placed = pin.place(&mut bytes, path);
    let ended = bytes.ended;
    // Closing the pipe ends a script that would continue to send.
    drop(bytes);
    let output = child.wait_with_output().context("Python cannot be waited for")?;
    match placed {
        // The bytes ended because the script failed; its output has the reason.
        Err(_) if ended && !output.status.success() => {
            bail!("{}", python::complaint(&output.stderr))
        }
        outcome => outcome,
    }
}

struct Watched<R> {
    inner: R,
    ended: bool,
}

impl<R: Read> Read for Watched<R> {
    fn read(&mut self, block: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(block)?;
        self.ended |= read == 0;
        Ok(read)
    }
}

/// Extracts the files from a verified archive, and checks each against its own pin.
pub(super) fn unpack(
    python: &Python,
    archive: &Path,
    member: &str,
    files: &[&PinnedFile],
    folder: &Path,
) -> Result<()> {
    let work = tempfile::tempdir().context("no temporary folder can be made")?;
    let rules = files
        .iter()
        .map(|file| format!("{}={}", member.replace("{path}", &file.path), file.name));
    let mut script = python.script(python::EXTRACT_TAR, [archive, work.path()]);
    script.args(rules);
    python::read(&mut script).context("the archive cannot be unpacked")?;
    for file in files {
        let mut unpacked =
            File::open(work.path().join(&file.name)).with_context(|| format!("{} was not unpacked", file.name))?;
        file.pin()
            .place(&mut unpacked, &folder.join(&file.name))
            .with_context(|| format!("{} in the archive", file.name))?;
    }
    Ok(())
}
