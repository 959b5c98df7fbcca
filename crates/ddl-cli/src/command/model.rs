//! Which model to take.

use clap::Args;
use ddl::{BuiltinModel, Ddl, DdlError, DeviceChoice, GoalModel, ModelSource};
use std::path::PathBuf;

/// A model by name, the program's own where none is named.
#[derive(Debug, Args)]
pub(crate) struct ModelChoice {
    /// Model: the directory of a run, a packed file (`ddl pack`), or a built-in model by the scene it was trained without:
    /// eth, hotel, univ, zara1 or zara2 [default: hotel, the built-in one that was trained on the most walkers]
    #[arg(long)]
    model: Option<PathBuf>,
}

impl ModelChoice {
    fn source(&self) -> ModelSource {
        match &self.model {
            None => ModelSource::Builtin(BuiltinModel::default()),
            Some(name) => ModelSource::named(name),
        }
    }

    pub(crate) fn load(&self, device: DeviceChoice) -> Result<Ddl, DdlError> {
        Ddl::open(&self.source(), device)
    }

    /// What goals come from alone: a run's may be there before its network is trained.
    pub(crate) fn load_goals(&self, device: DeviceChoice) -> Result<GoalModel, DdlError> {
        GoalModel::open(&self.source(), device)
    }
}
