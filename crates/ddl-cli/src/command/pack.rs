//! `ddl pack`: a model as one small file.

mod finished_benchmark;

use crate::command::Telling;
use crate::output;
use crate::paths::{ModelPath, OutputPlace};
use clap::Args;
use ddl::{Ddl, DeviceChoice, ModelSource};
use serde_json::json;
use std::path::Path;

/// Pack a trained model into one small file, without its tracks
///
/// The file holds the weights of both networks in half precision and the configuration of the run, but no trajectory
/// data: the packed model proposes all of its goals with its network. Every command with --model takes the file. The
/// row "DDL as packed" in the results of the run shows the errors without the tracks.
#[derive(Debug, Args)]
#[command(mut_arg("progress", |arg| arg.help(crate::command::NO_PROGRESS)))]
#[command(after_help = "Example:\n  ddl pack --model runs/zara1 --out zara1.safetensors")]
pub(crate) struct Pack {
    /// Directory of a finished run
    #[arg(long, required_unless_present = "benchmark", value_hint = clap::ValueHint::AnyPath)]
    model: Option<ModelPath>,
    /// Folder of a finished benchmark on star recordings instead of --model: packs one file for each fold, with its
    /// results, as for the models that come with the program
    #[arg(long, value_name = "DIR", conflicts_with = "model", value_hint = clap::ValueHint::AnyPath)]
    benchmark: Option<ModelPath>,
    /// Seed of the runs to pack [default: the lowest of the benchmark]
    #[arg(long, requires = "benchmark")]
    seed: Option<u64>,
    /// File to write; for a benchmark, folder to write to
    #[arg(long, value_name = "FILE", value_hint = clap::ValueHint::AnyPath)]
    out: OutputPlace,
    #[command(flatten)]
    telling: Telling,
}

impl Pack {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let packed = match (&self.benchmark, &self.model) {
            (Some(benchmark), _) => finished_benchmark::pack(benchmark, self.seed, &self.out)?,
            (None, Some(model)) => vec![(self.out.to_path_buf(), pack_model(model, &self.out)?)],
            (None, None) => Vec::new(),
        };
        if self.telling.json {
            let files = packed.iter();
            let files: Vec<_> = files.map(|(file, numbers)| json!({"file": file, "weights": numbers})).collect();
            return match (&self.benchmark, &files[..]) {
                (None, [file]) => output::print_json(file),
                _ => output::print_json(&files),
            };
        }
        for (file, numbers) in packed {
            output::print(&format!("{}: {numbers} weights\n", file.display()))?;
        }
        Ok(())
    }
}

/// Writes the packed model, and returns the number of its weights.
fn pack_model(model: &Path, out: &Path) -> anyhow::Result<usize> {
    let model = Ddl::open(&ModelSource::named(model), DeviceChoice::Cpu)?;
    model.pack(out)?;
    Ok(model.parameter_count() + model.goal_model().parameter_count())
}
