//! Training of one fold into a run directory. It can be stopped and resumed.

pub(crate) mod best_epoch;
#[cfg(feature = "torch")]
mod early_stopping;
#[cfg(feature = "torch")]
mod goals;
#[cfg(feature = "torch")]
mod stages;
#[cfg(feature = "torch")]
mod starting_weights;
pub(crate) mod words;

use crate::error::DdlError;
use crate::goals::recipe::GoalRecipe;
use crate::model::source::ModelSource;
use crate::run::directory::RunDirectory;
use crate::run::track_units::TrackUnits;
use ddl_data::Dataset;
use ddl_network::{DeviceChoice, ProposalStep, StarConfig, StepReport, TrainingConfig};
use std::ops::ControlFlow;

/// What to train, and the directory for it.
#[derive(Debug, Clone)]
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
    /// Keeps the weights of the last epoch only, instead of the weights of about 20 epochs, from which the protocol
    /// `published` chooses.
    pub last_epoch_only: bool,
    /// The last stage to train; a later call can continue.
    pub until: TrainingStage,
    /// The run's directory.
    pub out: RunDirectory,
    /// The device to compute on.
    pub device: DeviceChoice,
    /// Commit of the program, for the record.
    pub commit: String,
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
    pub steps: (u64, u64),
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

/// Trains the fold, or continues an earlier call. Returns at once if training is done.
///
/// `observe` is called after every step and may ask to stop: the state is then saved, and the result is
/// [`DdlError::Interrupted`].
///
/// # Errors
/// Unreadable data, a directory that holds another run, an unavailable device, or a loss that is not finite (the last
/// good state is kept); [`DdlError::WithoutLibtorch`] in a program without libtorch.
#[cfg(feature = "torch")]
pub fn train(
    request: &TrainingRequest,
    dataset: &Dataset,
    observe: impl FnMut(&TrainingProgress) -> ControlFlow<()>,
) -> Result<(), DdlError> {
    stages::train(request, dataset, observe)
}

/// Training needs libtorch, which this program is built without.
///
/// # Errors
/// [`DdlError::WithoutLibtorch`], which tells how to build with it.
#[cfg(not(feature = "torch"))]
pub fn train(
    _: &TrainingRequest,
    _: &Dataset,
    _: impl FnMut(&TrainingProgress) -> ControlFlow<()>,
) -> Result<(), DdlError> {
    Err(DdlError::WithoutLibtorch { what: "training" })
}
