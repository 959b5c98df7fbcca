//! `cargo xtask fuzz`: runs the fuzz targets of `tests/fuzz` and prints a table of the results.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};

use crate::libtorch::{self, Request};
use crate::workspace::{Workspace, absolute, find_on_path};

const FOLDER: &str = "tests/fuzz";
/// Temporary files of model readers are put into this memory file system if it exists.
const MEMORY: &str = "/dev/shm";
const HEADING: &str = "| target | executions | a second | corpus | result |\n|---|---:|---:|---:|---|\n";

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Only these targets [default: all]
    targets: Vec<String>,
    /// Executions of each target
    #[arg(long, default_value_t = 10_000_000)]
    executions: u64,
    /// Stop a target after this many seconds, even if it has not finished its executions
    #[arg(long, value_name = "SECONDS")]
    most_seconds: Option<u64>,
    /// Sanitizer to build with; libtorch is not built for any
    #[arg(long, value_enum, default_value_t = Sanitizer::None)]
    sanitizer: Sanitizer,
    /// Do not trace comparisons: for inputs that only select edits, where compared values cannot be inserted
    #[arg(long)]
    no_trace_compares: bool,
    /// Only targets that need no libtorch; nothing is set up
    #[arg(long)]
    no_torch: bool,
    /// Also write the table to this file, as markdown
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Sanitizer {
    None,
    Address,
}

/// A fuzz target of `tests/fuzz/Cargo.toml`.
#[derive(Debug, PartialEq, Eq)]
struct Target {
    name: String,
    needs_torch: bool,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        for tool in ["rustup", "cargo-fuzz"] {
            if find_on_path(tool.as_ref()).is_none() {
                bail!(
                    "{tool} is missing; with rustup, install the rest by\n  rustup toolchain install nightly\n  \
                     cargo install cargo-fuzz"
                );
            }
        }
        let manifest = workspace.path(FOLDER).join("Cargo.toml");
        let manifest =
            fs::read_to_string(&manifest).with_context(|| format!("{} cannot be read", manifest.display()))?;
        let targets = self.chosen(targets(&manifest)?)?;
        let library = if targets.iter().any(|target| target.needs_torch) {
            let ready = libtorch::ensure(workspace, &Request::default())?;
            Some(ready.folder.join("lib"))
        } else {
            None
        };
        let table = self.table.as_deref().map(absolute).transpose()?;
        let mut rows = HEADING.to_owned();
        let mut broken = Vec::new();
        for Target { name, .. } in targets {
            let found = workspace.path("target/fuzz-corpus").join(&name);
            fs::create_dir_all(&found).with_context(|| format!("{} cannot be made", found.display()))?;
            eprintln!("fuzz: {name}");
            let (log, passed) = run(&mut self.command(workspace, &name, &found, library.as_deref()))?;
            let corpus = fs::read_dir(&found).map_or(0, Iterator::count);
            let row = row(&name, &log, corpus, passed);
            rows += &row.with_context(|| format!("{name} was not fuzzed (above)"))?;
            if let Some(table) = &table {
                // After each target, so that an interrupted run keeps its results.
                fs::write(table, &rows).with_context(|| format!("{} cannot be written", table.display()))?;
            }
            if !passed {
                broken.push(name);
            }
        }
        println!("{rows}");
        if !broken.is_empty() {
            bail!(
                "{} failed; the inputs are in {FOLDER}/artifacts: fix the reader, and add each input to the corpus",
                broken.join(", ")
            );
        }
        Ok(())
    }

    fn chosen(&self, all: Vec<Target>) -> Result<Vec<Target>> {
        for asked in &self.targets {
            match all.iter().find(|target| target.name == *asked) {
                None => {
                    let names: Vec<&str> = all.iter().map(|target| target.name.as_str()).collect();
                    bail!("there is no fuzz target {asked}; the targets are {}", names.join(", "));
                }
                Some(target) if target.needs_torch && self.no_torch => {
                    bail!("the fuzz target {asked} needs libtorch: leave --no-torch out");
                }
                Some(_) => {}
            }
        }
        let is_asked = |target: &Target| {
            let is_named = self.targets.is_empty() || self.targets.contains(&target.name);
            is_named && !(self.no_torch && target.needs_torch)
        };
        Ok(all.into_iter().filter(is_asked).collect())
    }

    fn command(&self, workspace: &Workspace, name: &str, found: &Path, library: Option<&Path>) -> Command {
        let sanitizer = match self.sanitizer {
            Sanitizer::None => "none",
            Sanitizer::Address => "address",
        };
        let mut command = Command::new("rustup");
        command
            .args(["run", "nightly", "cargo", "fuzz", "run", name])
            .args(["--fuzz-dir", FOLDER, "--target-dir", "target/fuzz"])
            .args(["--sanitizer", sanitizer])
            .args(library.map_or(&[][..], |_| &["--features", "torch"]))
            .args(self.no_trace_compares.then_some("--no-trace-compares"))
            .arg(found)
            .arg(workspace.path(FOLDER).join("corpus").join(name))
            .args(["--", "-max_len=1024", "-timeout=5", "-rss_limit_mb=2048"])
            .args(["-malloc_limit_mb=64", "-print_final_stats=1"])
            .arg(format!("-runs={}", self.executions))
            .args(self.most_seconds.map(|s| format!("-max_total_time={s}")))
            .current_dir(workspace.root())
            .env_remove("RUSTFLAGS")
            .env_remove("RUSTUP_TOOLCHAIN")
            .envs(library.map(|library| ("LD_LIBRARY_PATH", library)))
            .envs(Path::new(MEMORY).is_dir().then_some(("TMPDIR", MEMORY)))
            .stdin(Stdio::null())
            .stderr(Stdio::piped());
        command
    }
}

/// The output of libFuzzer, and whether it found no fault. After a fault, the end of the log is printed.
fn run(command: &mut Command) -> Result<(String, bool)> {
    let output = command.output().context("rustup cannot be started")?;
    let log = String::from_utf8_lossy(&output.stderr).into_owned();
    let passed = output.status.success();
    if !passed {
        let lines: Vec<&str> = log.lines().collect();
        eprintln!("{}", lines[lines.len().saturating_sub(60)..].join("\n"));
    }
    Ok((log, passed))
}

fn targets(manifest: &str) -> Result<Vec<Target>> {
    let table: toml::Table = manifest.parse().context("its Cargo.toml is damaged")?;
    let bins = table.get("bin").and_then(toml::Value::as_array);
    let target = |bin: &toml::Value| {
        Some(Target {
            name: bin.get("name")?.as_str()?.to_owned(),
            needs_torch: bin.get("required-features").is_some(),
        })
    };
    Ok(bins.into_iter().flatten().filter_map(target).collect())
}

/// A row of the table; `None` if nothing was executed.
fn row(name: &str, log: &str, corpus: usize, passed: bool) -> Option<String> {
    let number = |what: &str| -> Option<u64> {
        let line = log.lines().find(|line| line.starts_with(what))?;
        line.split(':').next_back()?.trim().parse().ok()
    };
    let executions = number("stat::number_of_executed_units")?;
    let rate = number("stat::average_exec_per_sec").unwrap_or(0);
    let result = if passed { "no fault" } else { "broke" };
    Some(format!("| {name} | {executions} | {rate} | {corpus} | {result} |\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_has_a_corpus_and_a_file() {
        let folder = Workspace::find().unwrap().path(FOLDER);
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        let all = targets(&manifest).unwrap();
        assert!(all.len() > 20 && all.iter().any(|target| target.needs_torch));
        for Target { name, .. } in all {
            let file = folder.join(format!("fuzz_targets/{name}.rs"));
            assert!(file.is_file(), "{name}");
            let seeds = fs::read_dir(folder.join("corpus").join(&name)).unwrap();
            assert!(seeds.count() >= 10, "{name}");
        }
    }

    #[test]
    fn the_output_of_libfuzzer_becomes_a_row() {
        let log = "Done 10 runs\nstat::number_of_executed_units: 10\nstat::average_exec_per_sec:     5\n";
        let expected = "| table | 10 | 5 | 3 | no fault |\n";
        assert_eq!(row("table", log, 3, true).as_deref(), Some(expected));
        assert_eq!(row("table", "error: no such target", 3, false), None);
    }
}
