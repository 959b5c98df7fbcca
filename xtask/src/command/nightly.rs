//! `cargo xtask nightly`: what takes too long for `ci`. docs/reliability.md says when each was run, and its figures.

use std::fs;
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;

use super::{docs, set_up};
use crate::browser;
use crate::debian;
use crate::libtorch::{self, Request};
use crate::process::run;
use crate::recordings::{RECORDED, choose};
use crate::tools::cargo_tool;
use crate::workspace::Workspace;

/// A name, what is checked, and the check; its words are those after `--`.
type Check = (&'static str, &'static str, fn(&Workspace, &[String]) -> Result<()>);

const CHECKS: [Check; 8] = [
    (
        "faults",
        "killed processes, full disks, damaged files, large crowds (-- NAME of a test)",
        faults,
    ),
    (
        "fuzz",
        "every reader of untrusted input (-- TARGET...; RUNS=10000000, SANITIZER=none)",
        fuzz,
    ),
    (
        "mutants",
        "the tests find changes of the numeric code (-- options of cargo-mutants)",
        mutants,
    ),
    (
        "cluster",
        "the benchmark on a real Slurm of two nodes on this machine",
        cluster,
    ),
    ("sanitizer", "vector arithmetic with AddressSanitizer", sanitizer),
    (
        "packages",
        "every crate is built from its package, as for a registry",
        packages,
    ),
    ("wheel", "the wheel for users, and its tests", wheel),
    ("site", "every page of the documentation in a browser", site),
];

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The check, or `all` [default: list them]
    #[arg(value_parser = names())]
    name: Option<String>,
    /// Words for the check
    #[arg(last = true, requires = "name")]
    rest: Vec<String>,
}

fn names() -> Vec<&'static str> {
    CHECKS.iter().map(|(name, ..)| *name).chain(["all"]).collect()
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let Some(asked) = self.name else {
            for (name, what, _) in CHECKS {
                println!("{name:<10} {what}");
            }
            return Ok(());
        };
        let mut failed = Vec::new();
        for (name, what, check) in CHECKS {
            if asked != name && asked != "all" {
                continue;
            }
            let start = Instant::now();
            let outcome = check(workspace, &self.rest);
            let result = if outcome.is_ok() { "passed" } else { "failed" };
            println!("| {name}: {what} | {result} | {} s |", start.elapsed().as_secs());
            failed.extend(outcome.err().map(|error| format!("{name}: {error:#}")));
        }
        ensure!(failed.is_empty(), "{}", failed.join("\n"));
        Ok(())
    }
}

/// Prints the rows of the table of docs/reliability.md.
fn faults(workspace: &Workspace, words: &[String]) -> Result<()> {
    set_up(workspace)?;
    let file = workspace.path("target/faults.md");
    fs::write(&file, "").with_context(|| format!("{} cannot be written", file.display()))?;
    // The test `program` makes cargo build the program. One after the other, because they measure time and memory.
    let tests = "test -p ddl-tests -p ddl-cli --features ddl-tests/torch,ddl-cli/torch --test program --test faults \
                 --test faults_torch -- --test-threads 1 --nocapture";
    let mut tests = workspace.cargo(tests.split(' '));
    tests
        .args(words)
        .env("OMP_NUM_THREADS", "1")
        // With this variable the tests use the full number of repetitions.
        .env("DDL_FAULTS_FIGURES", &file);
    let outcome = run(&mut tests);
    let rows = fs::read_to_string(&file).context("the figures cannot be read")?;
    let mut rows: Vec<&str> = rows.lines().collect();
    rows.sort_unstable();
    println!("| fault | tried | found |\n|---|---|---|\n{}", rows.join("\n"));
    outcome?;
    ensure!(
        !rows.is_empty(),
        "no figures: no test was chosen, or all were skipped (above)"
    );
    Ok(())
}

fn fuzz(workspace: &Workspace, words: &[String]) -> Result<()> {
    let fuzz = cargo_tool(workspace, "cargo-fuzz", "0.13.2")?;
    let libtorch = libtorch::ensure(workspace, &Request::default())?.folder.join("lib");
    let mut script = workspace.program("bash");
    script.arg("tests/fuzz/run.sh").args(words);
    run(script.env("CARGO_FUZZ", fuzz).env("LD_LIBRARY_PATH", libtorch))
}

fn mutants(workspace: &Workspace, words: &[String]) -> Result<()> {
    let mutants = cargo_tool(workspace, "cargo-mutants", "27.1.0")?;
    let mut command = workspace.program(mutants);
    // In a common folder, the tests of two mutants that run at the same time would overwrite each other.
    command.env_remove("CARGO_TARGET_DIR").arg("mutants").args(words);
    run(&mut command)
}

fn cluster(workspace: &Workspace, words: &[String]) -> Result<()> {
    debian::ensure_program("slurmctld", &["slurmctld", "slurmd", "munge"])?;
    set_up(workspace)?;
    let Some(folder) = choose(workspace, None, None)?.folder else {
        bail!("the check needs recordings: `cargo xtask data fetch`");
    };
    run(&mut workspace.cargo(["build", "--package", "ddl-cli", "--features", "torch"]))?;
    let mut script = workspace.program("python3");
    script
        .arg("tests/cluster/check_cluster.py")
        .arg("target/debug/ddl")
        .arg(&folder);
    let convention = RECORDED.iter().find(|name| folder.ends_with(name)).copied();
    run(script.arg(convention.unwrap_or("star")).args(words))
}

fn sanitizer(workspace: &Workspace, words: &[String]) -> Result<()> {
    let tests = "run nightly cargo test --lib --tests --target x86_64-unknown-linux-gnu --target-dir target/sanitizer \
                 -p ddl-softdtw -p ddl-network -p ddl-goal";
    let mut rustup = workspace.program("rustup");
    rustup
        .args(tests.split(' '))
        .args(words)
        .env("RUSTFLAGS", "-Zsanitizer=address")
        .env_remove("RUSTUP_TOOLCHAIN");
    run(&mut rustup)
}

fn packages(workspace: &Workspace, _: &[String]) -> Result<()> {
    set_up(workspace)?;
    // Packages are built without the workspace's profiles; a separate folder keeps the two builds from invalidating
    // each other.
    let publish = "publish --workspace --dry-run --allow-dirty --target-dir target/publish";
    run(&mut workspace.cargo(publish.split(' ')))
}

fn wheel(workspace: &Workspace, words: &[String]) -> Result<()> {
    super::python::make_and_test(workspace, words)
}

fn site(workspace: &Workspace, _: &[String]) -> Result<()> {
    docs::build(workspace, "ddl-cli/torch,ddl-cli/doc-only")?;
    let site = workspace.path(docs::SITE);
    browser::check(
        workspace,
        "tests/page/check_site.py",
        &site,
        Some(&workspace.path("target/screenshots")),
    )
}
