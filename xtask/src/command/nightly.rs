//! `cargo xtask nightly`: what takes too long for `ci`. docs/reliability.md says when each was run, and its figures.

use super::{c, docs, python, release, set_up, test, web};
use crate::browser;
use crate::debian;
use crate::libtorch::{self, LibtorchRequest};
use crate::process::{read, run};
use crate::recordings::bring_in;
use crate::tools::cargo_tool;
use crate::workspace::Workspace;
use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use std::fs;
use std::process::Command;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Size of a sample of mutants, of 17,000.
const MUTANTS: usize = 120;

#[derive(Debug, Args)]
pub(crate) struct NightlyArguments {
    /// The check [default: list them]
    name: Option<NightlyCheck>,
    /// Words for the check
    #[arg(last = true, requires = "name")]
    rest: Vec<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum NightlyCheck {
    /// Killed processes, full disks, damaged files, large crowds (-- NAME of a test)
    Faults,
    /// Every reader of untrusted input (-- TARGET...; RUNS=10000000, SANITIZER=none)
    Fuzz,
    /// The tests find changes of the code: a new sample each day (-- options of cargo-mutants)
    Mutants,
    /// The benchmark on a real Slurm of two nodes on this machine
    Cluster,
    /// Vector arithmetic with `AddressSanitizer`: it tests the `unsafe` code of `fearless_simd` under the kernels
    Sanitizer,
    /// Everything that a release consists of; each crate is built from its package
    Release,
    /// The wheel for users, and its tests
    Wheel,
    /// The ROS 2 node against another DDS for a minute: nothing lost, latency
    Node,
    /// The library for C and C++ that users get: two compilers, sanitizers, valgrind, size, memory, time
    C,
    /// Every page of the documentation in a browser
    Site,
    /// The page and the npm package that forecast, in a browser and in node
    Web,
    /// All of these
    All,
}

impl NightlyArguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let checks = NightlyCheck::value_variants();
        let Some(asked) = self.name else {
            for value in checks.iter().filter_map(NightlyCheck::to_possible_value) {
                let help = value.get_help().cloned().unwrap_or_default();
                println!("{:<10} {help}", value.get_name());
            }
            return Ok(());
        };
        let is_one = asked != NightlyCheck::All;
        ensure!(is_one || self.rest.is_empty(), "words are for one check: name it instead of all");
        let mut failed = Vec::new();
        let is_asked = |check: &&NightlyCheck| asked == **check || asked == NightlyCheck::All && **check != asked;
        for check in checks.iter().filter(is_asked) {
            let start = Instant::now();
            let outcome = check.run(workspace, &self.rest);
            let result = if outcome.is_ok() { "passed" } else { "failed" };
            println!("| {check:?} | {result} | {} s |", start.elapsed().as_secs());
            failed.extend(outcome.err().map(|error| format!("{check:?}: {error:#}")));
        }
        ensure!(failed.is_empty(), "{}", failed.join("\n"));
        Ok(())
    }
}

impl NightlyCheck {
    fn run(self, workspace: &Workspace, words: &[String]) -> Result<()> {
        match self {
            Self::Faults => faults(workspace, words),
            Self::Fuzz => fuzz(workspace, words),
            Self::Mutants => mutants(workspace, words),
            Self::Cluster => cluster(workspace, words),
            Self::Sanitizer => sanitizer(workspace, words),
            Self::Release => release::ReleaseArguments { dry_run: true }.run(workspace),
            Self::Wheel => python::PythonArguments::default().run(workspace),
            Self::Node => python::check_node_for_long(workspace),
            Self::C => c::check_all(workspace),
            Self::Site => {
                docs::build(workspace, docs::ALONE)?;
                let [site, pictures] = [docs::SITE, "target/screenshots"].map(|folder| workspace.path(folder));
                browser::check(workspace, "tests/page/check_site.py", &site, Some(&pictures))
            }
            Self::Web => web::build(workspace).and_then(|()| web::check(workspace)),
            Self::All => Ok(()),
        }
    }
}

fn faults(workspace: &Workspace, words: &[String]) -> Result<()> {
    set_up(workspace)?;
    let name = words.first().map_or("faults::", String::as_str);
    // One after the other, because they measure time and memory.
    let tests = "test --workspace --features ddl-cli/torch,ddl-tests/torch --test it --test it_torch -- \
                 --test-threads 1 --nocapture";
    let mut tests = workspace.cargo(tests.split(' '));
    // With the variable, the tests use the full number of repetitions.
    run(tests.arg(name).env("OMP_NUM_THREADS", "1").env("DDL_NIGHTLY", "1"))
}

fn fuzz(workspace: &Workspace, words: &[String]) -> Result<()> {
    let fuzz = cargo_tool(workspace, "cargo-fuzz", "0.13.2")?;
    let libtorch = libtorch::ensure(workspace, &LibtorchRequest::default())?.folder.join("lib");
    let mut script = workspace.program("bash");
    script.arg("tests/fuzz/run.sh").args(words);
    run(script.env("CARGO_FUZZ", fuzz).env("LD_LIBRARY_PATH", libtorch))
}

/// A sample of mutants, by the tests of their own crates; those that these miss, by the tests of the program.
fn mutants(workspace: &Workspace, words: &[String]) -> Result<()> {
    set_up(workspace)?;
    bring_in(workspace)?;
    let tool = cargo_tool(workspace, "cargo-mutants", "27.1.0")?;
    let recordings = workspace.recordings()?.unwrap_or_default();
    let mutants = |words: &[String]| {
        let mut command = workspace.program(&tool);
        // In a common folder, the tests of two mutants that run at the same time would overwrite each other.
        command.env_remove("CARGO_TARGET_DIR").arg("mutants").args(words);
        // The copies in which mutants are tested lack what git ignores: recordings, and where libtorch lies.
        let libtorch = workspace.path(".cargo/config.generated.toml");
        command.arg(format!("--cargo-arg=--config={}", libtorch.display()));
        command.env("DDL_DATASETS", &recordings);
        command
    };
    let words = if words.is_empty() { sample(&mut mutants(&["--list".to_owned()]))? } else { words.to_vec() };
    println!("cargo xtask nightly mutants -- {}", words.join(" "));
    let Err(failure) = run(&mut mutants(&words)) else { return Ok(()) };
    let missed = fs::read_to_string(workspace.path("target/mutants.out/missed.txt")).unwrap_or_default();
    ensure!(!missed.is_empty(), failure);
    // Names as regular expressions, whose special characters stand for themselves among others.
    let any = |name: &str| format!("^{}$", name.replace(|letter: char| !letter.is_alphanumeric(), "."));
    let again = missed.lines().map(|name| format!("--re={}", any(name)));
    let again = ["--test-package=ddl-tests".to_owned()].into_iter().chain(again);
    run(&mut mutants(&again.collect::<Vec<_>>()))
}

/// Every day another one.
fn sample(list: &mut Command) -> Result<Vec<String>> {
    let shards = (read(list)?.lines().count() / MUTANTS).max(1);
    let days = SystemTime::now().duration_since(UNIX_EPOCH)?.as_secs() / 86_400;
    let shard = format!("--shard={}/{shards}", days as usize % shards);
    Ok(vec![shard, "--sharding=round-robin".to_owned()])
}

fn cluster(workspace: &Workspace, words: &[String]) -> Result<()> {
    debian::ensure_program("slurmctld", &["slurmctld", "slurmd", "munge"])?;
    set_up(workspace)?;
    bring_in(workspace)?;
    test::build_with_torch(workspace)?;
    let mut check = workspace.program("python3");
    check.args(["tests/cluster/check_cluster.py", "target/debug/ddl"]);
    run(check.args(words))
}

fn sanitizer(workspace: &Workspace, words: &[String]) -> Result<()> {
    let tests = "run nightly cargo test --lib --tests --target x86_64-unknown-linux-gnu --target-dir target/sanitizer \
                 -p ddl-simd -p ddl-softdtw -p ddl-network -p ddl-goal";
    let mut rustup = workspace.program("rustup");
    rustup.args(tests.split(' ')).args(words).env("RUSTFLAGS", "-Zsanitizer=address").env_remove("RUSTUP_TOOLCHAIN");
    run(&mut rustup)
}
