//! `ddl info`.

use clap::Args;
use ddl::{Ddl, DeviceChoice, GoalModel, RunDirectory};
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
                if RunDirectory::new(path).is_trained() {
                    let model = Ddl::load(path, DeviceChoice::Cpu)?;
                    facts_of(model.goal_model(), &json!(model.parameter_count()))?
                } else {
                    let goals = GoalModel::load(path, DeviceChoice::Cpu)?;
                    facts_of(&goals, &json!("not trained yet"))?
                }
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

/// What a run was made with; `parameters` is what is known of its forecasting network.
fn facts_of(
    goals: &GoalModel,
    parameters: &serde_json::Value,
) -> anyhow::Result<serde_json::Value> {
    Ok(json!({
        "config": goals.config(),
        "parameters": parameters,
        "goal_parameters": goals.parameter_count(),
        "experts": goals.estimator().library().len(),
        "epochs": goals.run().metrics()?,
    }))
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
