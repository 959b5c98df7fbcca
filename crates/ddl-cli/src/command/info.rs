//! `ddl info`.

use clap::Args;
use ddl::{Ddl, DeviceChoice, GoalModel};
use serde_json::json;
use std::io::Write as _;
use std::path::PathBuf;

/// Describe a trained model, or this program when no model is given
#[derive(Debug, Args)]
pub(crate) struct Info {
    /// Directory of a run
    #[arg(long)]
    model: Option<PathBuf>,
    /// As JSON
    #[arg(long)]
    json: bool,
}

impl Info {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let facts = match &self.model {
            None => json!({
                "version": env!("CARGO_PKG_VERSION"),
                "cuda": ddl::cuda_status(),
            }),
            Some(path) => {
                let goals = GoalModel::load(path, DeviceChoice::Cpu)?;
                let network = if goals.run().is_trained() {
                    json!(Ddl::load(path, DeviceChoice::Cpu)?.parameter_count())
                } else {
                    json!("not trained yet")
                };
                json!({
                    "config": goals.config(),
                    "parameters": network,
                    "goal_parameters": goals.parameter_count(),
                    "experts": goals.estimator().library().len(),
                    "epochs": goals.run().metrics()?,
                })
            }
        };
        let mut out = std::io::stdout().lock();
        if self.json {
            writeln!(out, "{}", serde_json::to_string_pretty(&facts)?)?;
            return Ok(());
        }
        print_facts(&mut out, &facts, 0)?;
        Ok(())
    }
}

/// Nested facts as indented lines.
fn print_facts(
    out: &mut impl std::io::Write,
    facts: &serde_json::Value,
    depth: usize,
) -> std::io::Result<()> {
    let Some(map) = facts.as_object() else {
        return Ok(());
    };
    for (name, value) in map {
        let indent = "  ".repeat(depth);
        match value {
            serde_json::Value::Object(_) => {
                writeln!(out, "{indent}{name}:")?;
                print_facts(out, value, depth + 1)?;
            }
            serde_json::Value::Array(items) => {
                writeln!(out, "{indent}{name}:")?;
                for item in items {
                    writeln!(out, "{indent}  {item}")?;
                }
            }
            serde_json::Value::String(text) => writeln!(out, "{indent}{name}: {text}")?,
            other => writeln!(out, "{indent}{name}: {other}")?,
        }
    }
    Ok(())
}
