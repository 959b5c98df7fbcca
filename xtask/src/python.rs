//! Python 3, used for network access and archive formats, because its package client fetches libtorch anyway. The
//! scripts in `python/` make no decisions: hashes and names are checked here.

use std::env;
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::workspace::program_on_path;

pub(crate) const DOWNLOAD: &str = include_str!("python/download.py");
/// Prints the address of a file on the package index, found like pip does.
pub(crate) const INDEX_LINK: &str = include_str!("python/index_link.py");
pub(crate) const EXTRACT_ZIP: &str = include_str!("python/extract_zip.py");
pub(crate) const EXTRACT_TAR: &str = include_str!("python/extract_tar.py");

#[derive(Debug, Clone)]
pub(crate) struct Python {
    program: OsString,
}

impl Python {
    pub(crate) fn find() -> Result<Self> {
        let program = env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
        if !program_on_path(&program) {
            bail!(
                "Python 3 is missing ({} is not on the search path): install it, on Debian or \
                 Ubuntu with `apt install python3 python3-pip`",
                program.display()
            );
        }
        Ok(Self { program })
    }

    pub(crate) fn with_pip() -> Result<Self> {
        let python = Self::find()?;
        let has_pip = python
            .script("import pip", [] as [&str; 0])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status()
            .is_ok_and(|status| status.success());
        if !has_pip {
            bail!(
                "pip is missing from {}: install it, on Debian or Ubuntu with `apt install \
                 python3-pip`",
                python.program.display()
            );
        }
        Ok(python)
    }

    pub(crate) fn script<I>(&self, script: &str, arguments: I) -> Command
    where
        I: IntoIterator,
        I::Item: AsRef<std::ffi::OsStr>,
    {
        let mut command = Command::new(&self.program);
        command.arg("-c").arg(script).args(arguments).stdin(Stdio::null());
        command
    }

    pub(crate) fn file(&self, script: &Path) -> Command {
        let mut command = Command::new(&self.program);
        command.arg(script).stdin(Stdio::null());
        command
    }

    pub(crate) fn module(&self, module: &str) -> Command {
        let mut command = Command::new(&self.program);
        command.args(["-m", module]).stdin(Stdio::null());
        command
    }

    /// Free space on the disk that holds `folder`, in bytes.
    pub(crate) fn free_space(&self, folder: &Path) -> Result<u64> {
        let mut command = self.script(
            "import shutil, sys; print(shutil.disk_usage(sys.argv[1]).free)",
            [folder],
        );
        read(&mut command)?
            .trim()
            .parse()
            .context("Python did not print the free disk space")
    }
}

/// Runs a script and returns its output; the last line of its standard error is the error message.
pub(crate) fn read(command: &mut Command) -> Result<String> {
    let output = command.output().context("Python cannot be started")?;
    if !output.status.success() {
        bail!("{}", complaint(&output.stderr));
    }
    String::from_utf8(output.stdout).context("Python printed something that is not text")
}

pub(crate) fn complaint(stderr: &[u8]) -> String {
    let text = String::from_utf8_lossy(stderr);
    text.lines()
        .map(str::trim)
        .rfind(|line| !line.is_empty())
        .unwrap_or("Python stopped without an error message")
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_script_returns_its_output_or_its_error() {
        let python = Python::find().unwrap();
        let mut script = python.script("import sys; print(sys.argv[1] + '!')", ["hello"]);
        assert_eq!(read(&mut script).unwrap().trim(), "hello!");
        let mut script = python.script("import sys; sys.exit('the index is on fire')", ["x"]);
        assert_eq!(read(&mut script).unwrap_err().to_string(), "the index is on fire");
    }
}
