//! `cargo xtask python`: the wheel of the Python package, tested in a virtual environment.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use xshell::Cmd;

use crate::debian;
use crate::python::Python;
use crate::workspace::{Workspace, absolute, program_on_path, step};

/// Pinned packages of the test environment, besides the wheel.
const REQUIREMENTS: &str = "crates/ddl-python/tests/requirements.txt";
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

/// Default folder of the wheel and its test environment.
const FOLDER: &str = "target/python";

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let out = absolute(&workspace.root().join(&self.out))?;
        let wheel = make(workspace, &out, RELEASED)?;
        println!("{}", wheel.display());
        if !self.no_tests {
            test(workspace, &out, &wheel, &self.rest)?;
        }
        Ok(())
    }
}

/// The first half of the check in `ci`.
pub(super) fn build_wheel(workspace: &Workspace) -> Result<()> {
    // The profile of the tests, so that dependencies are built only once.
    make(workspace, &workspace.path(FOLDER), "dev").map(drop)
}

/// The second half: tests the wheel of the first half.
pub(super) fn test_built(workspace: &Workspace) -> Result<()> {
    let out = workspace.path(FOLDER);
    test(workspace, &out, &wheel_in(&out)?, &[])
}

/// Creates the environment and builds the wheel.
fn make(workspace: &Workspace, out: &Path, profile: &str) -> Result<PathBuf> {
    let environment = out.join(ENVIRONMENT);
    make_environment(workspace, &environment)?;
    build(workspace, &environment, out, profile)
}

/// A new virtual environment with the packages needed for building and testing.
fn make_environment(workspace: &Workspace, folder: &Path) -> Result<()> {
    let python = Python::with_pip()?;
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("{} cannot be removed", folder.display()))?;
    }
    let made = python.module("venv").arg(folder).status();
    if !made.is_ok_and(|status| status.success()) {
        bail!(
            "no virtual environment could be created: install Python's venv, on Debian or Ubuntu with \
             `apt install python3-venv`"
        );
    }
    let pip = in_environment(workspace, folder, "pip")
        .args(["install", "--quiet", "--disable-pip-version-check"])
        .args(["--only-binary=:all:", "--requirement", REQUIREMENTS]);
    step("pip install", &pip)
}

fn build(workspace: &Workspace, environment: &Path, out: &Path, profile: &str) -> Result<PathBuf> {
    let wheels = out.join("wheels");
    if wheels.exists() {
        fs::remove_dir_all(&wheels).with_context(|| format!("{} cannot be removed", wheels.display()))?;
    }
    let maturin = in_environment(workspace, environment, "maturin")
        .args(["build", "--quiet", "--profile", profile])
        .args(["--manifest-path", "crates/ddl-python/Cargo.toml", "--out"])
        .arg(&wheels)
        .arg("--interpreter")
        .arg(environment.join("bin/python"));
    step("maturin build", &maturin)?;
    let wheel = wheel_in(out)?;
    let size = fs::metadata(&wheel)?.len();
    if profile == RELEASED && size > LARGEST {
        bail!(
            "{} has {size} bytes, more than {LARGEST}: find out which files grew",
            wheel.display()
        );
    }
    Ok(wheel)
}

fn wheel_in(out: &Path) -> Result<PathBuf> {
    let built = fs::read_dir(out.join("wheels")).context("no wheel was built")?;
    built
        .filter_map(Result::ok)
        .map(|entry| entry.path())
        .find(|path| path.extension().is_some_and(|extension| extension == "whl"))
        .context("no wheel was built")
}

fn test(workspace: &Workspace, out: &Path, wheel: &Path, rest: &[String]) -> Result<()> {
    let environment = &out.join(ENVIRONMENT);
    let install = in_environment(workspace, environment, "pip")
        .args([
            "install",
            "--quiet",
            "--disable-pip-version-check",
            "--no-deps",
            "--force-reinstall",
        ])
        .arg(wheel);
    step("pip install of the wheel", &install)?;
    bring_in_broker();
    let tests = workspace.path("crates/ddl-python/tests");
    let checks = [
        ("mypy", vec!["-m", "mypy", "--strict", "-p", "ddl_forecast"]),
        ("stubtest", vec!["-m", "mypy.stubtest", "ddl_forecast._core"]),
    ];
    for (name, arguments) in checks {
        // Run in a folder from which the package cannot be imported unless it is installed.
        let check = in_environment(workspace, environment, "python").args(arguments);
        step(name, &check)?;
    }
    let mut pytest = in_environment(workspace, environment, "python")
        .args(["-m", "pytest", "--quiet", "--durations", "5", "-c"])
        .arg(workspace.path("crates/ddl-python/pyproject.toml"))
        .arg(tests)
        .args(rest)
        .env("MPLBACKEND", "Agg");
    // In CI the benchmark has just built it.
    let program = workspace.path("target/debug/ddl");
    if std::env::var_os("CI").is_some() && program.is_file() {
        pytest = pytest.env("DDL_PROGRAM", program);
    }
    if let Some(folder) = super::test::recordings(workspace)? {
        pytest = pytest.env("DDL_DATASETS", folder);
    }
    step("pytest", &pytest)
}

/// Installs the MQTT broker for a test, if possible. Without it the test prints what is missing, and fails in CI.
fn bring_in_broker() {
    if !program_on_path("mosquitto_sub".as_ref()) && debian::can_install() {
        let installed = debian::install(&["mosquitto", "mosquitto-clients"]);
        if let Err(error) = installed {
            eprintln!("{error:#}");
        }
    }
}

/// A program of the environment, with the environment variables of a plain cargo.
fn in_environment<'a>(workspace: &'a Workspace, environment: &Path, program: &str) -> Cmd<'a> {
    let path = environment.join("bin").join(program);
    workspace
        .program(&path)
        .env("VIRTUAL_ENV", environment)
        .env_remove("PYTHONPATH")
}
