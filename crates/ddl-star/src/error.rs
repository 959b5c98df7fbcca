//! What can go wrong in this crate.

use std::path::PathBuf;

/// Errors of `ddl-star`. Messages say what is wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StarError {
    /// A configuration value is outside its range.
    #[error("configuration: {field} = {value} is not allowed: {rule}")]
    Config {
        /// Name of the field.
        field: &'static str,
        /// The value given.
        value: String,
        /// What is allowed.
        rule: &'static str,
    },
    /// Tensors or windows of unexpected size.
    #[error("{operation}: expected {expected}, got {got}")]
    Shape {
        /// The operation that found it.
        operation: &'static str,
        /// What the operation needs.
        expected: String,
        /// What it was given.
        got: String,
    },
    /// The device asked for cannot be had.
    #[error("device {device}: {problem}")]
    Device {
        /// The device asked for.
        device: String,
        /// Why it cannot be used, and what to do.
        problem: String,
    },
    /// A checkpoint that must not be trusted.
    #[error("checkpoint {}: {problem}", path.display())]
    Checkpoint {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, and what to do.
        problem: String,
    },
    /// A learned tensor that cannot be rounded, or does not belong to the network it is given to.
    #[error("weights: {tensor} {problem}")]
    Weights {
        /// Name of the tensor.
        tensor: String,
        /// What is wrong with it, and what to do.
        problem: String,
    },
    /// The loss or its gradient is no longer a number.
    #[error(
        "epoch {epoch}, batch {batch}: the {quantity} is {value}; the last good checkpoint is kept; \
         lower the learning rate or look at the windows of that batch ({windows})"
    )]
    NonFinite {
        /// Epoch, counted from 1.
        epoch: usize,
        /// Batch within the training set, counted from 0.
        batch: usize,
        /// "loss" or "gradient norm".
        quantity: &'static str,
        /// The value met.
        value: f64,
        /// First window of the batch, as recording@frame.
        windows: String,
    },
    /// The loss of the proposal network or its gradient is no longer a number.
    #[error(
        "step {step} of the proposal network: the {quantity} is {value}; the last good checkpoint is \
         kept; lower the learning rate or look at the walkers of that batch (the first is number \
         {example} of the {}examples, counted from 0)",
        if *reversed { "reversed " } else { "" }
    )]
    ProposalNonFinite {
        /// Steps done before.
        step: u64,
        /// "loss" or "gradient norm".
        quantity: &'static str,
        /// The value met.
        value: f64,
        /// First example of the batch, within the examples or within the reversed ones, counted from 0.
        example: usize,
        /// Whether it is one of the reversed examples.
        reversed: bool,
    },
    /// Training was given nothing to learn from.
    #[error(
        "no training windows: every epoch needs at least one window with its future, somebody seen at 20 steps of 0.4 s in a row"
    )]
    NoTrainingWindows,
    /// Reading or writing a file failed.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// libtorch reported an error.
    #[error("libtorch: {0}")]
    Torch(#[from] tch::TchError),
}
