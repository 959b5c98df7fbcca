//! `cargo xtask python`: the wheel of the Python package, tested in a virtual environment.

use crate::debian;
use crate::process::{read, run};
use crate::python::Python;
use crate::workspace::{Workspace, remove_folder};
use anyhow::{Context, Result, ensure};
use clap::Args;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Pinned packages of the test environment, besides the wheel.
const REQUIREMENTS: &str = "crates/ddl-python/tests/requirements.txt";
/// The folder of the wheel, and the virtual environment beside it.
const WHEELS: &str = "target/python/wheels";
const ENVIRONMENT: &str = "target/python/environment";
/// Largest size of a wheel in bytes: `pip install` should not fetch more.
const LARGEST: u64 = 14_000_000;

#[derive(Debug, Default, Args)]
pub(crate) struct PythonArguments {
    /// Only build the wheel
    #[arg(long)]
    no_tests: bool,
    /// Passed to pytest, as in `-- -k live`
    #[arg(last = true)]
    rest: Vec<String>,
}

impl PythonArguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        make_environment(workspace)?;
        let wheel = build(workspace)?;
        println!("{}", wheel.display());
        if !self.no_tests {
            let mut pip = pip_install(workspace);
            run(pip.args(["--no-deps", "--force-reinstall"]).arg(wheel))?;
            test(workspace, &self.rest)?;
        }
        Ok(())
    }
}

/// The first part of the check in `ci`.
pub(super) fn prepare(workspace: &Workspace) -> Result<()> {
    // Without the MQTT broker a test prints what is missing, and fails in CI.
    if let Err(error) = debian::ensure_program("mosquitto_sub", &["mosquitto", "mosquitto-clients"]) {
        eprintln!("{error:#}");
    }
    make_environment(workspace)
}

/// The second part: the tests on the library that `ci` has built with everything else. maturin would compile all crates
/// again with other features of their dependencies; `cargo xtask nightly wheel` tests what it makes.
pub(super) fn check(workspace: &Workspace) -> Result<()> {
    let folder = "import sysconfig; print(sysconfig.get_path('platlib'))";
    let site = read(in_environment(workspace, "python").args(["-c", folder]))?;
    let package = Path::new(site.trim()).join("ddl_forecast");
    fs::create_dir_all(&package)?;
    let sources = fs::read_dir(workspace.path("crates/ddl-python/python/ddl_forecast"))?.flatten();
    for file in sources.filter(|file| file.path().is_file()) {
        fs::copy(file.path(), package.join(file.file_name()))?;
    }
    let library = workspace.path("target/debug/lib_core.so");
    fs::copy(&library, package.join("_core.abi3.so")).with_context(|| library.display().to_string())?;
    let bin = workspace.path(ENVIRONMENT).join("bin");
    let program = "import sys; from ddl_forecast.__main__ import main; sys.exit(main())";
    let script = format!("#!/bin/sh\nexec {}/python -c '{program}' \"$@\"\n", bin.display());
    fs::write(bin.join("ddl"), script)?;
    run(Command::new("chmod").arg("755").arg(bin.join("ddl")))?;
    test(workspace, &[])?;
    run(&mut test_node(workspace, "target/debug/ddl-ros2"))
}

/// For a minute, and as fast as users have it.
pub(super) fn check_node_for_long(workspace: &Workspace) -> Result<()> {
    make_environment(workspace)?;
    run(&mut workspace.cargo("build --release --package ddl-ros2".split(' ')))?;
    let mut pytest = test_node(workspace, "target/release/ddl-ros2");
    run(pytest.arg("-rP").env("DDL_NIGHTLY", "1"))
}

/// The tests of the ROS 2 node, which need another DDS.
fn test_node(workspace: &Workspace, program: &str) -> Command {
    let mut pytest = in_environment(workspace, "python");
    pytest
        .args(["-m", "pytest", "--quiet", "--durations", "3"])
        .arg(workspace.path("crates/ddl-ros2/tests"))
        .env("DDL_ROS2", workspace.path(program));
    pytest
}

/// A new virtual environment with the packages needed for building and testing.
fn make_environment(workspace: &Workspace) -> Result<()> {
    let python = Python::find()?;
    run(python.call(["-m", "venv", "--clear"]).arg(workspace.path(ENVIRONMENT))).context(
        "no virtual environment could be created: install Python's venv, on Debian or Ubuntu with \
         `apt install python3-venv`",
    )?;
    run(pip_install(workspace).args(["--only-binary=:all:", "--requirement", REQUIREMENTS]))
}

fn build(workspace: &Workspace) -> Result<PathBuf> {
    let wheels = workspace.path(WHEELS);
    remove_folder(&wheels)?;
    let mut maturin = in_environment(workspace, "maturin");
    maturin.args("build --quiet --profile wheel --manifest-path crates/ddl-python/Cargo.toml --out".split(' '));
    let interpreter = workspace.path(ENVIRONMENT).join("bin/python");
    run(maturin.arg(&wheels).arg("--interpreter").arg(interpreter))?;
    let mut built = fs::read_dir(&wheels).context("no wheel was built")?.flatten();
    let is_wheel = |path: &PathBuf| path.extension() == Some(OsStr::new("whl"));
    let wheel = built.find_map(|entry| Some(entry.path()).filter(is_wheel));
    let wheel = wheel.context("no wheel was built")?;
    let size = fs::metadata(&wheel)?.len();
    ensure!(size <= LARGEST, "{} has {size} bytes, more than {LARGEST}: find out which files grew", wheel.display());
    Ok(wheel)
}

fn test(workspace: &Workspace, rest: &[String]) -> Result<()> {
    for check in ["-m mypy --strict -p ddl_forecast", "-m mypy.stubtest ddl_forecast._core"] {
        run(in_environment(workspace, "python").args(check.split(' ')))?;
    }
    let mut pytest = in_environment(workspace, "python");
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

fn pip_install(workspace: &Workspace) -> Command {
    let mut pip = in_environment(workspace, "pip");
    pip.args(["install", "--quiet", "--disable-pip-version-check"]);
    pip
}

/// A program of the environment, with the environment variables of a plain cargo.
fn in_environment(workspace: &Workspace, program: &str) -> Command {
    let environment = workspace.path(ENVIRONMENT);
    let mut command = workspace.program(environment.join("bin").join(program));
    command.env("VIRTUAL_ENV", environment).env_remove("PYTHONPATH");
    command
}
