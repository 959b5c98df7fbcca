//! What can go wrong in this crate.

use ddl_network::NetworkError;

/// Errors of `ddl-star`. Messages say what is wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StarError {
    /// A configuration, shape, weight or file that no implementation of the networks takes.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The device asked for cannot be had.
    #[error("device {device}: {problem}")]
    Device {
        /// The device asked for.
        device: String,
        /// Why it cannot be used, and what to do.
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
         kept; lower the learning rate or look at the pedestrians of that batch (the first is number \
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
    /// libtorch reported an error.
    #[error("libtorch: {0}")]
    Torch(#[from] tch::TchError),
}

impl From<StarError> for NetworkError {
    fn from(error: StarError) -> Self {
        match error {
            StarError::Network(error) => error,
            other => Self::Backend(Box::new(other)),
        }
    }
}
