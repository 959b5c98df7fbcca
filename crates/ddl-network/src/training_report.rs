//! What training tells of its steps and epochs.

use serde::{Deserialize, Serialize};

/// What one step did.
#[derive(Debug, Clone, PartialEq)]
pub struct StepReport {
    /// Epoch of the step, counted from 1.
    pub epoch: usize,
    /// Steps done in that epoch, this one included.
    pub done: usize,
    /// Steps of an epoch.
    pub steps_per_epoch: usize,
    /// Mean loss (square metres) of the steps whose losses were read with this one; `None` when none was.
    /// On CUDA every sixteenth step and the last of an epoch read several.
    pub loss: Option<f64>,
    /// Set when the step was the last of its epoch.
    pub finished_epoch: Option<EpochReport>,
}

/// One line of `metrics.jsonl`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EpochReport {
    /// Counted from 1. Number 0, where a caller measured the network before its first step, has neither loss nor batches.
    pub epoch: usize,
    /// Mean of the batches' losses, square metres.
    pub loss: f64,
    /// Batches of the epoch.
    pub batches: usize,
    /// Seconds it took.
    pub seconds: f64,
    /// Error on validation windows, metres, where somebody measured it; the trainer does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub validation: Option<f64>,
}

/// What one step of the proposal network did.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposalStep {
    /// Steps done, this one included.
    pub done: u64,
    /// Running mean of the training distance (metres): relaxed at first, of the nearest end at last.
    pub distance: f64,
}
