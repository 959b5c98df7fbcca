//! `cargo xtask mutants`: inserts faults into the numeric code one at a time, and counts how many the tests find.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail};
use clap::Args;
use serde::Deserialize;

use crate::cargo_tool::CargoTool;
use crate::workspace::Workspace;

const TOOL: CargoTool = CargoTool {
    name: "cargo-mutants",
    version: "27.1.0",
    options: &[],
    version_call: &["mutants", "--version"],
};

/// The numeric crates without libtorch, and the numeric files in their `src`.
const NUMERIC: [(&str, &[&str]); 7] = [
    ("ddl-simd", &["**"]),
    ("ddl-softdtw", &["**"]),
    ("ddl-dynamics", &["**"]),
    ("ddl-goal", &["**"]),
    (
        "ddl-data",
        &[
            "augment",
            "completion",
            "homography",
            "neighbours",
            "rate",
            "rule",
            "simulate/**",
            "window",
        ],
    ),
    (
        "ddl-network",
        &["backbone/**", "forecast/**", "kernel/**", "proposal/**"],
    ),
    ("ddl-eval", &["baseline/**", "metric/**", "region", "significance/**"]),
];
/// Errors and tests affect no forecast.
const EXCLUDED: [&str; 3] = ["**/error.rs", "**/tests.rs", "**/tests/**"];

/// These functions only decide whether other threads are woken, so no result depends on them.
const WITHOUT_RESULT: &str = r"(in|replace) (\w+::)?work( |$)";

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Only these crates [default: all with numeric code]
    #[arg(long = "crate", value_name = "NAME", value_parser = NUMERIC.map(|(name, _)| name))]
    crates: Vec<String>,
    /// Only files that match this pattern, such as `crates/ddl-simd/src/exp2.rs`
    #[arg(long = "file", value_name = "PATTERN")]
    files: Vec<String>,
    /// Passed to cargo-mutants, as in `-- --jobs 2`
    #[arg(last = true)]
    rest: Vec<String>,
}

/// The counts of cargo-mutants for one crate (`mutants.out/outcomes.json`).
#[derive(Debug, Default, PartialEq, Eq, Deserialize)]
struct Counts {
    caught: usize,
    missed: usize,
    /// Mutants with which the tests did not end in time; these count as found.
    timeout: usize,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let tool = TOOL.ensure(workspace)?;
        let asked = |name: &str| self.crates.is_empty() || self.crates.iter().any(|one| one == name);
        let mut rows = HEADING.to_owned();
        for (name, places) in NUMERIC.into_iter().filter(|(name, _)| asked(name)) {
            let patterns = if self.files.is_empty() {
                let pattern = |place: &&str| match place.strip_suffix("**") {
                    Some(folder) => format!("crates/{name}/src/{folder}**/*.rs"),
                    None => format!("crates/{name}/src/{place}.rs"),
                };
                places.iter().map(pattern).collect()
            } else {
                self.files.clone()
            };
            let out = workspace.path("target/mutants").join(name);
            let call = || {
                let mut call = Command::new(&tool);
                // In a common folder, the tests of two mutants that run at the same time would overwrite each other.
                call.current_dir(workspace.root())
                    .env_remove("CARGO_TARGET_DIR")
                    .args(["mutants", "--package", name]);
                call.args(patterns.iter().flat_map(|pattern| ["--file", pattern]));
                call.args(EXCLUDED.iter().flat_map(|pattern| ["--exclude", pattern]));
                call.args(["--exclude-re", WITHOUT_RESULT]);
                call
            };
            let files = call().arg("--list-files").output();
            let files = files.context("cargo-mutants cannot be started")?.stdout;
            let counts = mutate(call().args(&self.rest), &out)?;
            rows += &row(name, String::from_utf8_lossy(&files).lines().count(), &counts);
            println!("{rows}");
        }
        Ok(())
    }
}

/// Runs cargo-mutants, whose output stays in `out`, and reads its counts.
fn mutate(call: &mut Command, out: &Path) -> Result<Counts> {
    fs::create_dir_all(out).with_context(|| format!("{} cannot be made", out.display()))?;
    // The examples of the documentation are left out: they are compiled one by one, again for every mutant.
    let status = call
        .arg("--output")
        .arg(out)
        .args(["--cargo-test-arg", "--tests", "--no-shuffle"])
        .status()
        .context("cargo-mutants cannot be started")?;
    // 2: mutants were missed; 3: tests did not end.
    if !matches!(status.code(), Some(0 | 2 | 3)) {
        bail!("cargo-mutants failed (above): {status}");
    }
    let file = out.join("mutants.out/outcomes.json");
    let text = fs::read(&file).with_context(|| format!("{} cannot be read", file.display()))?;
    serde_json::from_slice(&text).with_context(|| format!("{} is damaged", file.display()))
}

const HEADING: &str = "| crate | files | mutants that compile | caught | missed | caught, share |\n\
    |---|---:|---:|---:|---:|---:|\n";

fn row(name: &str, files: usize, counts: &Counts) -> String {
    let caught = counts.caught + counts.timeout;
    let viable = caught + counts.missed;
    let share = if viable == 0 {
        "–".to_owned()
    } else {
        format!("{:.1} %", 100.0 * caught as f64 / viable as f64)
    };
    format!(
        "| {name} | {files} | {viable} | {caught} | {} | {share} |\n",
        counts.missed
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_counts_of_cargo_mutants_become_a_row() {
        let outcomes = r#"{"outcomes": [], "total_mutants": 9, "missed": 1, "caught": 6, "timeout": 1, "unviable": 1}"#;
        let counts: Counts = serde_json::from_str(outcomes).unwrap();
        assert_eq!(row("ddl-simd", 2, &counts), "| ddl-simd | 2 | 8 | 7 | 1 | 87.5 % |\n");
        assert!(row("ddl-simd", 0, &Counts::default()).ends_with("| – |\n"));
    }

    #[test]
    fn every_path_of_the_table_exists() {
        let workspace = Workspace::find().unwrap();
        for (name, places) in NUMERIC {
            for place in places {
                let path = workspace
                    .path(&format!("crates/{name}/src/{place}"))
                    .with_extension("rs");
                let folder = path.parent().unwrap();
                assert!(
                    path.is_file() || place.ends_with("**") && folder.is_dir(),
                    "{name}: {place}"
                );
            }
        }
    }
}
