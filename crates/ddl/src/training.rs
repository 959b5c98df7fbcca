//! Training of one fold into a run directory. It can be stopped and resumed.

pub(crate) mod best_epoch;
#[cfg(feature = "torch")]
mod early_stopping;
#[cfg(feature = "torch")]
mod goals;
pub(crate) mod request;
#[cfg(feature = "torch")]
mod stages;
#[cfg(feature = "torch")]
mod starting_weights;

use crate::error::DdlError;
use crate::training::request::{TrainingProgress, TrainingRequest};
use ddl_data::Dataset;
use std::ops::ControlFlow;

/// Trains the fold, or continues an earlier call. Returns at once if training is done.
///
/// `observe` is called after every step and may ask to stop: the state is then saved, and the result is
/// [`DdlError::Interrupted`].
///
/// # Errors
/// Unreadable data, a directory that holds another run, an unavailable device, or a loss that is not finite (the last
/// good state is kept); [`DdlError::WithoutLibtorch`] in a program without libtorch, which tells how to build with it.
#[cfg_attr(not(feature = "torch"), expect(unused_variables, reason = "training needs libtorch"))]
pub fn train(
    request: &TrainingRequest,
    dataset: &Dataset,
    observe: impl FnMut(&TrainingProgress) -> ControlFlow<()>,
) -> Result<(), DdlError> {
    #[cfg(feature = "torch")]
    return stages::train(request, dataset, observe);
    #[cfg(not(feature = "torch"))]
    Err(DdlError::WithoutLibtorch { what: "training" })
}
