//! Training of one fold into a run directory, stopped and resumed at will.

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

/// What to train, and where to put it.
#[derive(Debug, Clone)]
pub struct TrainingRequest {
    /// The fold whose test scene is left out.
    pub fold: String,
    /// Size and variant of the forecasting network.
    pub star: StarConfig,
    /// How to train.
    pub training: TrainingConfig,
    /// Share of the training recordings' time, at their ends, kept for validation; 0 for none.
    pub validation: f64,
    /// Training recordings kept for validation whole.
    pub validation_recordings: Vec<String>,
    /// What the goals come from.
    pub goals: GoalRecipe,
    /// The model whose weights both networks begin with; `None`: random ones. With [`patience`](Self::patience) it is
    /// an epoch like the others, number 0.
    pub from: Option<ModelSource>,
    /// End early when the validation error has not fallen for so many epochs, and take the best epoch for the model; `None`: all epochs, and the
    /// last.
    pub patience: Option<usize>,
    /// What the numbers of own recordings mean, for the record; `None` where nothing was said.
    pub units: Option<TrackUnits>,
    /// Keep the weights of the last epoch alone, and not those of some 20 among which the protocol `published` chooses.
    pub last_epoch_only: bool,
    /// The last stage to train; a later call may go on.
    pub until: TrainingStage,
    /// The run's directory.
    pub out: RunDirectory,
    /// Where to compute.
    pub device: DeviceChoice,
    /// Commit of the program, for the record.
    pub commit: String,
}

/// The stages of a training, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum TrainingStage {
    /// What the goals come from: the expert library and the proposal network.
    Goals,
    /// The forecasting network.
    Network,
}

/// What training tells its observer.
#[derive(Debug, Clone, PartialEq)]
pub struct TrainingProgress {
    /// Steps of the stage done and in all.
    pub steps: (u64, u64),
    /// The step just done.
    pub step: TrainingStep,
}

/// A step of one of the stages.
#[derive(Debug, Clone, PartialEq)]
pub enum TrainingStep {
    /// Of the proposal network.
    Goals(ProposalStep),
    /// Of the forecasting network.
    Network(StepReport),
}

/// Trains the fold, or goes on where an earlier call stopped, or returns at once when it is done.
///
/// `observe` is called after every step and may ask to stop: the state is then saved and the result
/// is [`DdlError::Interrupted`].
///
/// # Errors
/// Unreadable data, a directory that holds another run, a device that is not there, or a loss that
/// is no longer a number (the last good state is kept); [`DdlError::WithoutLibtorch`] in a program without it.
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
/// [`DdlError::WithoutLibtorch`], which says how to get it.
#[cfg(not(feature = "torch"))]
pub fn train(
    _: &TrainingRequest,
    _: &Dataset,
    _: impl FnMut(&TrainingProgress) -> ControlFlow<()>,
) -> Result<(), DdlError> {
    Err(DdlError::WithoutLibtorch { what: "training" })
}
