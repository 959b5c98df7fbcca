//! Pinned contents: a length and a SHA-256, checked while the bytes are copied.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::Path;

use anyhow::{Context, Result, bail};
use sha2::{Digest, Sha256};

const BLOCK: usize = 1 << 16;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Pin<'a> {
    pub(crate) sha256: &'a str,
    pub(crate) bytes: u64,
}

impl Pin<'_> {
    /// Copies `from` to `to` and checks the pin, up to the first byte too many. After an error the caller must discard
    /// the written bytes.
    pub(crate) fn copy(&self, from: &mut impl Read, to: &mut impl Write) -> Result<()> {
        let mut bytes = 0_u64;
        let mut hasher = Sha256::new();
        each_block(from, |block| {
            bytes += block.len() as u64;
            if bytes > self.bytes {
                bail!("longer than the pinned {} bytes", self.bytes);
            }
            hasher.update(block);
            to.write_all(block).context("writing stopped: is the disk full?")
        })?;
        if bytes < self.bytes {
            bail!("ended after {bytes} of {} bytes", self.bytes);
        }
        let sha256 = hexadecimal(hasher);
        if sha256 != self.sha256 {
            bail!("wrong contents: SHA-256 {sha256}, pinned is {}", self.sha256);
        }
        Ok(())
    }

    pub(crate) fn check(&self, path: &Path) -> Result<()> {
        File::open(path)
            .context("cannot be opened")
            .and_then(|mut file| self.copy(&mut file, &mut std::io::sink()))
            .with_context(|| path.display().to_string())
    }

    /// Writes `from` to `path`, complete and right, or not at all: a temporary file is renamed once length and hash
    /// agree.
    pub(crate) fn place(&self, from: &mut impl Read, path: &Path) -> Result<()> {
        let folder = path.parent().context("the path of the file has no folder")?;
        fs::create_dir_all(folder).with_context(|| format!("{} cannot be created", folder.display()))?;
        let mut builder = tempfile::Builder::new();
        let builder = builder.prefix(".incoming-");
        // Temporary files are private by default.
        #[cfg(unix)]
        let builder = builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
        let mut temporary = builder
            .tempfile_in(folder)
            .with_context(|| format!("{} cannot be written to", folder.display()))?;
        self.copy(from, &mut temporary)?;
        temporary
            .as_file()
            .sync_all()
            .context("writing stopped: is the disk full?")?;
        temporary
            .persist(path)
            .with_context(|| format!("{} cannot be written", path.display()))?;
        Ok(())
    }
}

pub(crate) fn measure(path: &Path) -> Result<(String, u64)> {
    let mut file = File::open(path).with_context(|| format!("{} cannot be opened", path.display()))?;
    let mut hasher = Sha256::new();
    let mut bytes = 0;
    each_block(&mut file, |block| {
        bytes += block.len() as u64;
        hasher.update(block);
        Ok(())
    })
    .with_context(|| path.display().to_string())?;
    Ok((hexadecimal(hasher), bytes))
}

fn each_block(from: &mut impl Read, mut take: impl FnMut(&[u8]) -> Result<()>) -> Result<()> {
    let mut block = vec![0_u8; BLOCK];
    loop {
        match from.read(&mut block).context("reading stopped")? {
            0 => return Ok(()),
            read => take(&block[..read])?,
        }
    }
}

fn hexadecimal(hasher: Sha256) -> String {
    let digest = hasher.finalize();
    digest.iter().fold(String::new(), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// SHA-256 of "abc", from FIPS 180-4's examples.
    const ABC: Pin<'static> = Pin {
        sha256: "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
        bytes: 3,
    };

    fn placed(bytes: &[u8]) -> (Result<()>, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        let outcome = ABC.place(&mut &bytes[..], &folder.path().join("abc"));
        let names = fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        (outcome, names)
    }

    #[test]
    fn wrong_short_and_long_bytes_leave_nothing_behind() {
        for (bytes, complaint) in [
            (&b"abd"[..], "wrong contents"),
            (b"ab", "ended after 2 of 3 bytes"),
            (b"", "ended after 0 of 3 bytes"),
            (b"abcd", "longer than the pinned 3 bytes"),
        ] {
            let (outcome, names) = placed(bytes);
            let message = format!("{:#}", outcome.unwrap_err());
            assert!(message.contains(complaint), "{message}");
            assert!(names.is_empty(), "{names:?}");
        }
    }
}
