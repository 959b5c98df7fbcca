//! `ddl info`: facts about a model or the program.

use crate::command::Telling;
use crate::output;
use crate::paths::ModelPath;
use clap::Args;
use ddl::data::Fold;
use ddl::{BuiltinModel, Ddl, DeviceChoice, GoalModel, ModelSource, RunDirectory};
use serde_json::json;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Describe a model, or this program
#[derive(Debug, Args)]
#[command(mut_arg("progress", |arg| arg.help(crate::command::NO_PROGRESS)))]
pub(crate) struct Info {
    /// Directory of a run, a packed file, or the name of a built-in model [default: the program itself]
    #[arg(value_name = "MODEL", value_hint = clap::ValueHint::AnyPath)]
    model: Option<ModelPath>,
    /// The model as in other commands
    #[arg(long = "model", value_name = "MODEL", conflicts_with = "model", hide = true)]
    named: Option<PathBuf>,
    #[command(flatten)]
    telling: Telling,
}

impl Info {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let (summary_line, facts) = match self.model.as_deref().or(self.named.as_deref()) {
            None => (None, of_program()),
            Some(name) => {
                let source = ModelSource::named(name);
                if source.run().is_none_or(RunDirectory::is_trained) {
                    let model = Ddl::open(&source, DeviceChoice::Cpu)?;
                    let goals = model.goal_model();
                    let parameters = json!(model.parameter_count());
                    (Some(summary(goals, "trained")), facts_of(goals, &parameters)?)
                } else {
                    let goals = GoalModel::open(&source, DeviceChoice::Cpu)?;
                    let parameters = json!("not trained yet");
                    (Some(summary(&goals, "to be trained")), facts_of(&goals, &parameters)?)
                }
            }
        };
        if self.telling.json {
            return output::print_json(&facts);
        }
        let mut text = summary_line.map_or_else(String::new, |line| line + "\n\n");
        write_facts(&mut text, &facts, 0)?;
        output::print(&text)
    }
}

fn of_program() -> serde_json::Value {
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "commit": env!("DDL_BUILT_FROM"),
        "cuda": ddl::cuda_status(),
        "models": BuiltinModel::ALL.map(BuiltinModel::name),
    })
}

fn summary(goals: &GoalModel, trained: &str) -> String {
    let config = goals.config();
    let data = &config.data;
    let left_out = match data.fold.as_str() {
        Fold::NO_HELD_OUT => String::new(),
        scene => format!(", without {scene}"),
    };
    format!(
        "{}: variant {}, {trained} on {} pedestrian-windows of 20 steps (convention {}{left_out}); goals {}",
        goals.source(),
        config.star.variant,
        data.pedestrians,
        data.convention,
        goals.words()
    )
}

fn facts_of(goals: &GoalModel, parameters: &serde_json::Value) -> anyhow::Result<serde_json::Value> {
    let epochs = goals.source().run().map_or(Ok(Vec::new()), RunDirectory::metrics)?;
    Ok(json!({
        "config": goals.config(),
        "parameters": parameters,
        "goal_parameters": goals.parameter_count(),
        "goals": goals.words(),
        "experts": goals.estimator().map_or(0, |estimator| estimator.library().tracks().len()),
        "epochs": epochs,
    }))
}

fn write_facts(out: &mut String, facts: &serde_json::Value, depth: usize) -> std::fmt::Result {
    let Some(map) = facts.as_object() else {
        return Ok(());
    };
    for (name, value) in map {
        let indent = "  ".repeat(depth);
        match value {
            serde_json::Value::Object(_) => {
                writeln!(out, "{indent}{name}:")?;
                write_facts(out, value, depth + 1)?;
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
