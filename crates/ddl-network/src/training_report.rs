//! Reports of training steps and epochs.

use serde::{Deserialize, Serialize};

/// Report of one training step.
#[derive(Debug, Clone, PartialEq)]
pub struct StepReport {
    /// Epoch of the step, counted from 1.
    pub epoch: usize,
    /// Mean loss of the batch: m² of next steps, m of whole walks.
    pub loss: f64,
    /// The report of the epoch, after its last step.
    pub finished_epoch: Option<EpochReport>,
}

/// One line of `metrics.jsonl`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EpochReport {
    /// Counted from 1. Number 0 is a measurement before the first step, with neither loss nor batches.
    pub epoch: usize,
    /// Mean of the losses of its batches: m² of next steps, m of whole walks.
    pub loss: f64,
    /// Batches in the epoch.
    pub batches: usize,
    /// Duration in seconds.
    pub seconds: f64,
    /// Error on validation windows (metres), if the caller measured it; the trainer does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub validation: Option<f64>,
}

/// Report of one training step of the proposal network.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposalStep {
    /// Steps done, including this one.
    pub done: u64,
    /// Running mean of the training distance (metres): at first of several nearest endpoints, at the end of the nearest
    /// one.
    pub distance: f64,
}
