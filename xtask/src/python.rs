//! Python 3, used for network access and archive formats, because its package client fetches libtorch anyway. What it
//! fetches is checked against SHA-256 sums of this repository.

use crate::process::{find_on_path, read};
use anyhow::{Result, ensure};
use std::env;
use std::ffi::{OsStr, OsString};
use std::process::Command;

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
        ensure!(read(&mut python.call(["-c", "import pip"])).is_ok(), "pip is missing from {shown}: {advice}");
        Ok(python)
    }

    pub(crate) fn call(&self, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Command {
        let mut command = Command::new(&self.program);
        command.args(arguments);
        command
    }
}
