//! `cargo xtask python`: the wheel of the Python package, tested in a virtual environment.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use clap::Args;

use crate::debian;
use crate::process::run;
use crate::python::Python;
use crate::workspace::{Workspace, absolute};

/// Pinned packages of the test environment, besides the wheel.
const REQUIREMENTS: &str = "crates/ddl-python/tests/requirements.txt";
/// Default folder of the wheel and its test environment.
const FOLDER: &str = "target/python";
/// The virtual environment, beside the wheel.
const ENVIRONMENT: &str = "environment";
/// Largest size of a wheel in bytes: `pip install` should not fetch more.
const LARGEST: u64 = 12_000_000;
/// The cargo profile of a wheel for users.
const RELEASED: &str = "wheel";

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Folder for the wheel
    #[arg(long, value_name = "DIR", default_value = FOLDER)]
    out: PathBuf,
    /// Only build the wheel
    #[arg(long)]
    no_tests: bool,
    /// Passed to pytest, as in `-- -k live`
    #[arg(last = true)]
    rest: Vec<String>,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let out = absolute(&workspace.root().join(&self.out))?;
        make_environment(workspace, &out)?;
        let wheel = build(workspace, &out, RELEASED)?;
        println!("{}", wheel.display());
        if !self.no_tests {
            test(workspace, &out, &wheel, &self.rest)?;
        }
        Ok(())
    }
}

/// The wheel for users, and its tests.
pub(super) fn make_and_test(workspace: &Workspace, rest: &[String]) -> Result<()> {
    let arguments = Arguments {
        out: FOLDER.into(),
        no_tests: false,
        rest: rest.to_vec(),
    };
    arguments.run(workspace)
}

/// The first part of the check in `ci`.
pub(super) fn prepare(workspace: &Workspace) -> Result<()> {
    // Without the MQTT broker a test prints what is missing, and fails in CI.
    if let Err(error) = debian::ensure_program("mosquitto_sub", &["mosquitto", "mosquitto-clients"]) {
        eprintln!("{error:#}");
    }
    make_environment(workspace, &workspace.path(FOLDER))
}

/// The second part: the wheel in the profile of the tests, so that dependencies are built only once.
pub(super) fn check(workspace: &Workspace) -> Result<()> {
    let out = workspace.path(FOLDER);
    let wheel = build(workspace, &out, "dev")?;
    test(workspace, &out, &wheel, &[])
}

/// A new virtual environment with the packages needed for building and testing.
fn make_environment(workspace: &Workspace, out: &Path) -> Result<()> {
    let python = Python::find()?;
    run(python.call(["-m", "venv", "--clear"]).arg(out.join(ENVIRONMENT))).context(
        "no virtual environment could be created: install Python's venv, on Debian or Ubuntu with \
         `apt install python3-venv`",
    )?;
    let options = ["--only-binary=:all:", "--requirement", REQUIREMENTS];
    run(pip_install(workspace, out).args(options))
}

fn build(workspace: &Workspace, out: &Path, profile: &str) -> Result<PathBuf> {
    let wheels = out.join("wheels");
    if wheels.exists() {
        fs::remove_dir_all(&wheels).with_context(|| format!("{} cannot be removed", wheels.display()))?;
    }
    let mut maturin = in_environment(workspace, out, "maturin");
    maturin
        .args(["build", "--quiet", "--profile", profile])
        .args(["--manifest-path", "crates/ddl-python/Cargo.toml", "--out"])
        .arg(&wheels)
        .arg("--interpreter")
        .arg(out.join(ENVIRONMENT).join("bin/python"));
    run(&mut maturin)?;
    let mut built = fs::read_dir(&wheels).context("no wheel was built")?.flatten();
    let is_wheel = |path: &PathBuf| path.extension() == Some(OsStr::new("whl"));
    let wheel = built.find_map(|entry| Some(entry.path()).filter(is_wheel));
    let wheel = wheel.context("no wheel was built")?;
    let size = fs::metadata(&wheel)?.len();
    ensure!(
        profile != RELEASED || size <= LARGEST,
        "{} has {size} bytes, more than {LARGEST}: find out which files grew",
        wheel.display()
    );
    Ok(wheel)
}

fn test(workspace: &Workspace, out: &Path, wheel: &Path, rest: &[String]) -> Result<()> {
    run(pip_install(workspace, out)
        .args(["--no-deps", "--force-reinstall"])
        .arg(wheel))?;
    for check in [
        ["mypy", "--strict", "-p", "ddl_forecast"].as_slice(),
        &["mypy.stubtest", "ddl_forecast._core"],
    ] {
        run(in_environment(workspace, out, "python").arg("-m").args(check))?;
    }
    let mut pytest = in_environment(workspace, out, "python");
    pytest
        .args(["-m", "pytest", "--quiet", "--durations", "5", "-c"])
        .arg(workspace.path("crates/ddl-python/pyproject.toml"))
        .arg(workspace.path("crates/ddl-python/tests"))
        .args(rest)
        .env("MPLBACKEND", "Agg");
    // In CI the benchmark has just built it.
    let program = workspace.path("target/debug/ddl");
    if std::env::var_os("CI").is_some() && program.is_file() {
        pytest.env("DDL_PROGRAM", program);
    }
    if let Some(folder) = workspace.recordings()? {
        pytest.env("DDL_DATASETS", folder);
    }
    run(&mut pytest)
}

fn pip_install(workspace: &Workspace, out: &Path) -> Command {
    let mut pip = in_environment(workspace, out, "pip");
    pip.args(["install", "--quiet", "--disable-pip-version-check"]);
    pip
}

/// A program of the environment, with the environment variables of a plain cargo.
fn in_environment(workspace: &Workspace, out: &Path, program: &str) -> Command {
    let environment = out.join(ENVIRONMENT);
    let mut command = workspace.program(environment.join("bin").join(program));
    command.env("VIRTUAL_ENV", environment).env_remove("PYTHONPATH");
    command
}
