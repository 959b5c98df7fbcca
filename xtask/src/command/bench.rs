//! `cargo xtask bench`: the micro-benchmarks of the crates.

use anyhow::{Context, Result};
use clap::Args;
use serde_json::Value;

use super::set_up;
use crate::workspace::{Workspace, step};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Only this package
    #[arg(long, short)]
    package: Option<String>,
    /// Handed to the benchmark programs, as in `-- --save-baseline before`
    #[arg(last = true)]
    rest: Vec<String>,
}

impl Arguments {
    /// Benchmark targets are named one by one: the test harness of a library would choke on the
    /// arguments meant for them.
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        set_up(workspace)?;
        let targets = targets(&workspace.metadata()?);
        let chosen: Vec<_> = targets
            .iter()
            .filter(|(package, _)| self.package.as_ref().is_none_or(|only| only == package))
            .collect();
        if chosen.is_empty() {
            let all: Vec<&str> = targets
                .iter()
                .map(|(package, _)| package.as_str())
                .collect();
            anyhow::bail!(
                "no such benchmarks: these packages have some: {}",
                all.join(", ")
            );
        }
        for (package, target) in chosen {
            let command = workspace
                .cargo(["bench", "--package", package, "--bench", target, "--"])
                .args(&self.rest);
            step(&format!("the benchmark {target} of {package}"), &command)?;
        }
        Ok(())
    }
}

/// Every benchmark target as (package, target).
fn targets(metadata: &Value) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        for target in package["targets"].as_array().into_iter().flatten() {
            let is_bench = target["kind"]
                .as_array()
                .is_some_and(|kinds| kinds.iter().any(|kind| kind.as_str() == Some("bench")));
            let names = package["name"]
                .as_str()
                .zip(target["name"].as_str())
                .context("no name");
            if let (true, Ok((package, target))) = (is_bench, names) {
                found.push((package.to_owned(), target.to_owned()));
            }
        }
    }
    found
}
