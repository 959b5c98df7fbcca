//! Errors of this crate.

use ddl_network::NetworkError;

/// Errors of `ddl-star`. A message states the fault, its place and the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StarError {
    /// An invalid configuration, shape, weight or file. All implementations of the networks report it with the same
    /// error.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The requested device is unavailable.
    #[error("device {device}: {problem}")]
    Device {
        /// The requested device.
        device: String,
        /// The reason and the remedy.
        problem: String,
    },
    /// The loss or its gradient is not finite.
    #[error(
        "epoch {epoch}, batch {batch}: the {quantity} is {value}; the last good checkpoint is kept; \
         lower the learning rate or check the windows of that batch ({windows})"
    )]
    NonFinite {
        /// Epoch, counted from 1.
        epoch: usize,
        /// Batch within the training set, counted from 0.
        batch: usize,
        /// "loss" or "gradient norm".
        quantity: &'static str,
        /// The value of that quantity.
        value: f64,
        /// First window of the batch, in the form `recording@frame`.
        windows: String,
    },
    /// The loss of the proposal network or its gradient is not finite.
    #[error(
        "step {step} of the proposal network: the {quantity} is {value}; the last good checkpoint is \
         kept; lower the learning rate or check the pedestrians of that batch (the first is number \
         {example} of the {}examples, counted from 0)",
        if *reversed { "reversed " } else { "" }
    )]
    ProposalNonFinite {
        /// Steps done before.
        step: u64,
        /// "loss" or "gradient norm".
        quantity: &'static str,
        /// The value of that quantity.
        value: f64,
        /// First example of the batch, counted from 0 within the examples or the reversed examples.
        example: usize,
        /// Whether it is a reversed example.
        reversed: bool,
    },
    /// There are no training windows.
    #[error(
        "no training windows: every epoch needs at least one window with a pedestrian observed at 20 consecutive time \
         steps of 0.4 s"
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
