//! `cargo xtask fuzz`: the fuzz targets of `tests/fuzz`, and a table of how far each came.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};

use crate::libtorch::{self, Request};
use crate::workspace::{Workspace, absolute, find_on_path};

const FOLDER: &str = "tests/fuzz";
/// Where memory is a folder, files of model readers are written and read without a disk.
const MEMORY: &str = "/dev/shm";

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Only these targets; otherwise all
    targets: Vec<String>,
    /// Executions of each target
    #[arg(long, default_value_t = 10_000_000)]
    executions: u64,
    /// Stop a target after so many seconds, however many executions it has done
    #[arg(long, value_name = "SECONDS")]
    most_seconds: Option<u64>,
    /// Sanitizer to build with; libtorch is not built for any
    #[arg(long, value_enum, default_value_t = Sanitizer::None)]
    sanitizer: Sanitizer,
    /// Do not trace comparisons: for inputs that only choose edits, which what is compared cannot be put into
    #[arg(long)]
    no_trace_compares: bool,
    /// Only targets that need no libtorch; nothing is set up
    #[arg(long)]
    no_torch: bool,
    /// Also write the table into this file, as markdown
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Sanitizer {
    None,
    Address,
}

/// A fuzz target, as `tests/fuzz/Cargo.toml` lists it.
#[derive(Debug, PartialEq, Eq)]
struct Target {
    name: String,
    needs_torch: bool,
}

/// How far a target came.
#[derive(Debug, PartialEq, Eq)]
struct Outcome {
    name: String,
    executions: u64,
    per_second: u64,
    corpus: usize,
    passed: bool,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        require_tools()?;
        let targets = self.chosen(workspace)?;
        let torch = targets.iter().any(|target| target.needs_torch);
        let library = if torch {
            let ready = libtorch::ensure(workspace, &Request::default())?;
            Some(ready.folder.join("lib"))
        } else {
            None
        };
        let table = self.table.as_deref().map(absolute).transpose()?;
        let mut outcomes = Vec::new();
        for target in &targets {
            outcomes.push(self.fuzz(workspace, target, torch, library.as_deref())?);
            if let Some(table) = &table {
                // After each target, so that an interrupted night is not lost.
                fs::write(table, markdown(&outcomes))
                    .with_context(|| format!("{} cannot be written", table.display()))?;
            }
        }
        println!("{}", markdown(&outcomes));
        let failed: Vec<&str> = outcomes
            .iter()
            .filter(|outcome| !outcome.passed)
            .map(|outcome| outcome.name.as_str())
            .collect();
        if !failed.is_empty() {
            bail!(
                "{} broke; the inputs are in {FOLDER}/artifacts: mend the reader, and put each into the corpus",
                failed.join(", ")
            );
        }
        Ok(())
    }

    fn chosen(&self, workspace: &Workspace) -> Result<Vec<Target>> {
        let manifest = workspace.path(FOLDER).join("Cargo.toml");
        let text = fs::read_to_string(&manifest)
            .with_context(|| format!("{} cannot be read", manifest.display()))?;
        let all = targets(&text)?;
        if let Some(unknown) = self
            .targets
            .iter()
            .find(|name| all.iter().all(|target| target.name != **name))
        {
            let names: Vec<&str> = all.iter().map(|target| target.name.as_str()).collect();
            bail!(
                "there is no fuzz target {unknown}; there are {}",
                names.join(", ")
            );
        }
        let needs_torch = |name: &&String| {
            let mut targets = all.iter();
            targets.any(|target| target.name == **name && target.needs_torch)
        };
        if let Some(name) = self
            .targets
            .iter()
            .find(needs_torch)
            .filter(|_| self.no_torch)
        {
            bail!("the fuzz target {name} needs libtorch: leave --no-torch out");
        }
        let asked = |target: &Target| {
            (self.targets.is_empty() || self.targets.contains(&target.name))
                && !(self.no_torch && target.needs_torch)
        };
        Ok(all.into_iter().filter(asked).collect())
    }

    fn fuzz(
        &self,
        workspace: &Workspace,
        target: &Target,
        torch: bool,
        library: Option<&Path>,
    ) -> Result<Outcome> {
        let name = &target.name;
        let found = workspace.path("target/fuzz-corpus").join(name);
        fs::create_dir_all(&found)
            .with_context(|| format!("{} cannot be made", found.display()))?;
        let mut command = Command::new("rustup");
        command
            .args(["run", "nightly", "cargo", "fuzz", "run", name])
            .args([
                "--fuzz-dir",
                FOLDER,
                "--target-dir",
                "target/fuzz",
                "--sanitizer",
            ])
            .arg(match self.sanitizer {
                Sanitizer::None => "none",
                Sanitizer::Address => "address",
            });
        if torch {
            command.args(["--features", "torch"]);
        }
        if self.no_trace_compares {
            command.arg("--no-trace-compares");
        }
        command
            .arg(&found)
            .arg(workspace.path(FOLDER).join("corpus").join(name))
            .args(["--", "-max_len=1024", "-timeout=5", "-rss_limit_mb=2048"])
            .args(["-malloc_limit_mb=64", "-print_final_stats=1"])
            .arg(format!("-runs={}", self.executions))
            .args(self.most_seconds.map(|s| format!("-max_total_time={s}")))
            .current_dir(workspace.root())
            .env_remove("RUSTFLAGS")
            .env_remove("RUSTUP_TOOLCHAIN")
            .stdin(Stdio::null())
            .stderr(Stdio::piped());
        if let Some(library) = library {
            command.env("LD_LIBRARY_PATH", library);
        }
        if Path::new(MEMORY).is_dir() {
            command.env("TMPDIR", MEMORY);
        }
        eprintln!("fuzz: {name}");
        let output = command.output().context("rustup cannot be started")?;
        let log = String::from_utf8_lossy(&output.stderr);
        let passed = output.status.success();
        if !passed {
            let lines: Vec<&str> = log.lines().collect();
            let end = lines.len().saturating_sub(60);
            eprintln!("{}", lines[end..].join("\n"));
            if number(&log, "stat::number_of_executed_units").is_none() {
                bail!("{name} was not fuzzed (above)");
            }
        }
        Ok(Outcome {
            name: name.clone(),
            executions: number(&log, "stat::number_of_executed_units").unwrap_or(0),
            per_second: number(&log, "stat::average_exec_per_sec").unwrap_or(0),
            corpus: fs::read_dir(&found).map_or(0, Iterator::count),
            passed,
        })
    }
}

/// Says how to get what is missing.
fn require_tools() -> Result<()> {
    if find_on_path("rustup".as_ref()).is_none() {
        bail!("fuzzing needs a nightly toolchain by rustup, which is not on the path");
    }
    if find_on_path("cargo-fuzz".as_ref()).is_none() {
        bail!(
            "cargo-fuzz is missing; get it and a nightly toolchain by\n  rustup toolchain install nightly\n  cargo install cargo-fuzz"
        );
    }
    Ok(())
}

/// The targets of a manifest, in its order.
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

/// The number that libFuzzer gives on the line of that name.
fn number(log: &str, name: &str) -> Option<u64> {
    let line = log.lines().find(|line| line.starts_with(name))?;
    line.split(':').next_back()?.trim().parse().ok()
}

fn markdown(outcomes: &[Outcome]) -> String {
    let mut text =
        "| target | executions | a second | corpus | result |\n|---|---:|---:|---:|---|\n"
            .to_owned();
    for outcome in outcomes {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} |",
            outcome.name,
            outcome.executions,
            outcome.per_second,
            outcome.corpus,
            if outcome.passed { "no fault" } else { "broke" }
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_has_a_corpus_and_a_file() {
        let workspace = Workspace::find().unwrap();
        let folder = workspace.path(FOLDER);
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        let all = targets(&manifest).unwrap();
        assert!(all.len() > 20 && all.iter().any(|target| target.needs_torch));
        for Target { name, .. } in all {
            assert!(
                folder.join(format!("fuzz_targets/{name}.rs")).is_file(),
                "{name}"
            );
            let seeds = fs::read_dir(folder.join("corpus").join(&name)).unwrap();
            assert!(seeds.count() >= 10, "{name}");
        }
    }

    #[test]
    fn what_libfuzzer_says_becomes_a_row() {
        let log =
            "Done 10 runs\nstat::number_of_executed_units: 10\nstat::average_exec_per_sec:     5\n";
        let outcome = Outcome {
            name: "table".to_owned(),
            executions: number(log, "stat::number_of_executed_units").unwrap(),
            per_second: number(log, "stat::average_exec_per_sec").unwrap(),
            corpus: 3,
            passed: true,
        };
        assert!(markdown(&[outcome]).ends_with("| table | 10 | 5 | 3 | no fault |\n"));
        assert_eq!(number("", "stat::number_of_executed_units"), None);
    }
}
