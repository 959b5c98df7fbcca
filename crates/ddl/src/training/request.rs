//! What to train, and the progress of it.

use crate::run::directory::RunDirectory;
use crate::run::goal_recipe::GoalRecipe;
use crate::run::model_source::ModelSource;
use crate::run::track_units::TrackUnits;
use ddl_core::WorkDone;
use ddl_network::{DeviceChoice, ProposalStep, StarConfig, StepReport, TrainingConfig, Variant};

/// What to train, and the directory for it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct TrainingRequest {
    /// The fold whose test scene is left out.
    pub fold: String,
    /// Size and variant of the forecasting network.
    pub star: StarConfig,
    /// The training of the forecasting network.
    pub training: TrainingConfig,
    /// Share of the training recordings' time, at their ends, kept for validation; 0 for none.
    pub validation: f64,
    /// Training recordings kept for validation as a whole.
    pub validation_recordings: Vec<String>,
    /// The origin of the goals.
    pub goals: GoalRecipe,
    /// The model whose weights both networks start with; `None`: random weights. With [`patience`](Self::patience) the
    /// starting weights count as epoch 0.
    pub from: Option<ModelSource>,
    /// Ends early when the validation error has not fallen for this many epochs, and takes the best epoch as the model.
    /// `None`: train all epochs, and take the last.
    pub patience: Option<usize>,
    /// The units of own recordings, for the record; `None` if not given.
    pub units: Option<TrackUnits>,
    /// The last stage to train; a later call can continue.
    pub until: TrainingStage,
    /// The run's directory.
    pub out: RunDirectory,
    /// The device to compute on.
    pub device: DeviceChoice,
    /// Commit of the program, for the record.
    pub commit: String,
}

impl TrainingRequest {
    /// The recommended training of the full variant without a validation part, on the CPU, with seed 1.
    #[must_use]
    pub fn recommended(fold: impl Into<String>, out: RunDirectory) -> Self {
        let training = TrainingConfig::recommended(Variant::Full);
        Self {
            fold: fold.into(),
            star: StarConfig::recommended(Variant::Full),
            goals: GoalRecipe::proposed(training.seed),
            training,
            validation: 0.0,
            validation_recordings: Vec::new(),
            from: None,
            patience: None,
            units: None,
            until: TrainingStage::Network,
            out,
            device: DeviceChoice::Cpu,
            commit: "unknown".to_owned(),
        }
    }
}

/// The stages of a training, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum TrainingStage {
    /// The goals: the expert library and the proposal network.
    Goals,
    /// The forecasting network.
    Network,
}

/// Progress of a training, for its observer.
#[derive(Debug, Clone, PartialEq)]
pub struct TrainingProgress {
    /// Steps of the stage done, and in total.
    pub steps: WorkDone,
    /// The step just done.
    pub step: TrainingStep,
}

/// A step of one of the stages.
#[derive(Debug, Clone, PartialEq)]
pub enum TrainingStep {
    /// A step of the proposal network.
    Goals(ProposalStep),
    /// A step of the forecasting network.
    Network(StepReport),
}
