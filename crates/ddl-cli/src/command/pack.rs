//! `ddl pack`.

use super::Telling;
use crate::output;
use clap::Args;
use ddl::{Ddl, DeviceChoice, ModelSource};
use serde_json::json;
use std::path::PathBuf;

/// Pack a trained model into one small file, without its tracks
///
/// The file holds the weights of both networks in half precision and the configuration of the run, and no trajectory data: goals
/// are then proposed by the network alone. Every command that takes a --model takes the file. How much the tracks would add, a row
/// "DDL without an expert library" in the results of the run says.
#[derive(Debug, Args)]
#[command(mut_arg("progress", |arg| arg.help(super::NO_PROGRESS)))]
#[command(after_help = "Example:\n  ddl pack --model runs/zara1 --out zara1.safetensors")]
pub(crate) struct Pack {
    /// Directory of a finished run
    #[arg(long)]
    model: PathBuf,
    /// File to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    telling: Telling,
}

impl Pack {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let model = Ddl::open(&ModelSource::named(&self.model), DeviceChoice::Cpu)?;
        model.pack(&self.out)?;
        let numbers = model.parameter_count() + model.goal_model().parameter_count();
        if self.telling.json {
            return output::print_json(&json!({"file": self.out, "weights": numbers}));
        }
        output::print(&format!("{}: {numbers} weights\n", self.out.display()))
    }
}
