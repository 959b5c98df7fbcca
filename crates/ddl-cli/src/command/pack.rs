//! `ddl pack`.

use clap::Args;
use ddl::{Ddl, DeviceChoice, ModelSource};
use std::io::Write as _;
use std::path::PathBuf;

/// Pack what it takes to forecast into one small file, without the tracks a model was trained on
///
/// The file holds the weights of both networks in half precision and the configuration of the run, and no trajectory data: goals
/// are then proposed by the network alone. Every command that takes a --model takes the file. How much the tracks would add, a row
/// "DDL without an expert library" in the results of the run says.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  ddl pack --model runs/zara1 --out zara1.safetensors")]
pub(crate) struct Pack {
    /// Directory of a finished run
    #[arg(long)]
    model: PathBuf,
    /// File to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

impl Pack {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let model = Ddl::open(&ModelSource::named(&self.model), DeviceChoice::Cpu)?;
        model.pack(&self.out)?;
        let numbers = model.parameter_count() + model.goal_model().parameter_count();
        let mut out = std::io::stdout().lock();
        writeln!(out, "{}: {numbers} weights", self.out.display())?;
        Ok(())
    }
}
