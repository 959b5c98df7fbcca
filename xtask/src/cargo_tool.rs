//! External programs that the checks run: pinned versions, built by cargo once per machine.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::cache;
use crate::workspace::{Workspace, find_on_path};

/// The tools run for about a second, so the settings minimise the build time.
const BUILD: [(&str, &str); 5] = [
    ("CARGO_PROFILE_RELEASE_OPT_LEVEL", "0"),
    ("CARGO_PROFILE_RELEASE_DEBUG", "false"),
    ("CARGO_PROFILE_RELEASE_LTO", "off"),
    ("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16"),
    ("CARGO_PROFILE_RELEASE_STRIP", "true"),
];

pub(crate) struct CargoTool {
    /// The name of its package and of its program.
    pub(crate) name: &'static str,
    pub(crate) version: &'static str,
    pub(crate) options: &'static [&'static str],
    pub(crate) version_call: &'static [&'static str],
}

impl CargoTool {
    /// The tool in its pinned version: from the search path, from the user's cache, or built from source.
    pub(crate) fn ensure(&self, workspace: &Workspace) -> Result<PathBuf> {
        let installed = find_on_path(OsStr::new(self.name));
        if let Some(program) = installed.filter(|program| self.is_pinned(program)) {
            return Ok(program);
        }
        let folder = cache::folder()?.join(format!("{}-{}", self.name, self.version));
        let program = self.program_in(&folder);
        if !self.is_pinned(&program) {
            let is_whole = |folder: &Path| self.is_pinned(&self.program_in(folder));
            cache::fill(&folder, is_whole, |work| self.build(workspace, work))?;
        }
        if !self.is_pinned(&program) {
            bail!(
                "{} does not run: delete {} and try again",
                program.display(),
                folder.display()
            );
        }
        Ok(program)
    }

    fn program_in(&self, folder: &Path) -> PathBuf {
        let suffix = std::env::consts::EXE_SUFFIX;
        folder.join(format!("bin/{}{suffix}", self.name))
    }

    fn is_pinned(&self, program: &Path) -> bool {
        let output = Command::new(program)
            .args(self.version_call)
            .stdin(Stdio::null())
            .stderr(Stdio::null())
            .output();
        output.is_ok_and(|output| {
            let said = String::from_utf8_lossy(&output.stdout);
            let version = said.trim().strip_prefix(self.name).map(str::trim_start);
            output.status.success() && version.map(|version| version.trim_start_matches('v')) == Some(self.version)
        })
    }

    fn build(&self, workspace: &Workspace, work: &Path) -> Result<PathBuf> {
        let Self { name, version, .. } = self;
        let tool = work.join("tool");
        eprintln!("building {name} {version}, once; this takes two to three minutes");
        let mut cargo = workspace.cargo_process();
        cargo
            .args(["install", name, "--locked", "--quiet", "--version"])
            .arg(format!("={version}"))
            .args(self.options)
            .arg("--root")
            .arg(&tool)
            .arg("--target-dir")
            .arg(work.join("build"))
            .envs(BUILD)
            .stdin(Stdio::null())
            // Tools must not use the configuration of the workspace, which has the path to libtorch.
            .current_dir(work);
        let status = cargo.status().context("cargo cannot be started")?;
        if !status.success() {
            bail!(
                "{name} {version} cannot be built (above): connect to the package index, or put a {name} {version} on \
             the search path"
            );
        }
        Ok(tool)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOOL: CargoTool = CargoTool {
        name: "hammer",
        version: "1.2.3",
        options: &[],
        version_call: &["--version"],
    };

    #[cfg(unix)]
    #[test]
    fn a_program_is_recognised_by_its_version() {
        use std::fs;
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        assert!(!TOOL.is_pinned(&TOOL.program_in(folder.path())));
        for (says, pinned) in [
            ("hammer 1.2.3", true),
            ("hammer v1.2.3", true),
            ("hammer 1.2.30", false),
            ("hammer 0.14.2", false),
            ("anvil 1.2.3", false),
        ] {
            let program = folder.path().join(says.replace(' ', "-"));
            fs::write(&program, format!("#!/bin/sh\necho {says}\n")).unwrap();
            fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
            assert_eq!(TOOL.is_pinned(&program), pinned, "{says}");
        }
    }
}
