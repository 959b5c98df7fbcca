//! Python 3, used for network access and archive formats, because its package client fetches libtorch anyway. What it
//! fetches is checked against SHA-256 sums of this repository.

use std::env;
use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::process::{find_on_path, read};

#[derive(Debug, Clone)]
pub(crate) struct Python {
    program: OsString,
}

impl Python {
    /// A Python 3 with pip: `$PYTHON`, or `python3`.
    pub(crate) fn find() -> Result<Self> {
        let program = env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
        let python = Self { program };
        let advice = "install it, on Debian or Ubuntu with `apt install python3 python3-pip`";
        let shown = python.program.display();
        ensure!(
            find_on_path(&python.program).is_some(),
            "Python 3 is missing ({shown} is not on the search path): {advice}"
        );
        ensure!(
            read(&mut python.call(["-c", "import pip"])).is_ok(),
            "pip is missing from {shown}: {advice}"
        );
        Ok(python)
    }

    pub(crate) fn call<I>(&self, arguments: I) -> Command
    where
        I: IntoIterator,
        I::Item: AsRef<OsStr>,
    {
        let mut command = Command::new(&self.program);
        command.args(arguments);
        command
    }

    /// `pip ACTION` with wheels only. It prints to standard error, because standard output may be evaluated by a shell.
    pub(crate) fn pip(&self, action: &str) -> Command {
        let mut pip = self.call(["-m", "pip", action, "--quiet", "--disable-pip-version-check"]);
        pip.args(["--only-binary=:all:", "--no-cache-dir", "--timeout", "60"])
            .env("PIP_ROOT_USER_ACTION", "ignore")
            .stdout(std::io::stderr());
        pip
    }

    /// Free space on the disk that holds `folder`, in bytes.
    pub(crate) fn free_space(&self, folder: &Path) -> Result<u64> {
        let script = "import shutil, sys; print(shutil.disk_usage(sys.argv[1]).free)";
        let mut command = self.call(["-c", script]);
        let text = read(command.arg(folder))?;
        text.trim().parse().context("Python did not print the free disk space")
    }
}
