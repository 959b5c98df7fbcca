//! Training curves.

use serde::{Deserialize, Serialize};

/// The loss of a training, epoch by epoch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrainingCurve {
    /// The fold: the scene not trained on.
    pub fold: String,
    /// The variant trained.
    pub variant: String,
    /// Seed of the training.
    pub seed: u64,
    /// Name of the loss with its unit, for the axis.
    pub loss: String,
    /// The finished epochs, in order.
    pub epochs: Vec<EpochPoint>,
}

/// One epoch of a [`TrainingCurve`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EpochPoint {
    /// Number of the epoch, from 1.
    pub epoch: usize,
    /// Mean training loss of its batches.
    pub loss: f64,
    /// Error on the validation split, m; `None` without a split.
    pub validation: Option<f64>,
    /// Duration in seconds.
    pub seconds: f64,
}
