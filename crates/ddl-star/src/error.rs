//! Errors of this crate.

use ddl_core::Setting;
use ddl_network::NetworkError;

/// Errors of `ddl-star`. A message states the fault, its place and the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StarError {
    /// An invalid configuration, shape, weight or file. All implementations of the networks report it with the same
    /// error.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// CUDA cannot be used.
    #[error("device cuda: {0}")]
    Device(#[from] CudaFault),
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

/// Why CUDA cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CudaFault {
    /// The driver shows no card to libtorch.
    #[error("libtorch finds no CUDA device; check the driver, or use {cpu}", cpu = Setting::Device.to("cpu"))]
    NoCard,
    /// libtorch's part for CUDA is not there.
    #[error(
        "libtorch_cuda.so cannot be loaded ({0}); put the lib folder of a CUDA build of torch 2.11.0 on \
         LD_LIBRARY_PATH (docs/libtorch.md), or use {cpu}",
        cpu = Setting::Device.to("cpu")
    )]
    NoLibrary(String),
    /// Work is to be recorded, and CUDA was not opened.
    #[error("libtorch_cuda.so is not loaded")]
    NotOpened,
    /// libtorch is of another release.
    #[error("{0}; training needs torch 2.11.0")]
    OtherRelease(String),
}

impl From<StarError> for NetworkError {
    fn from(error: StarError) -> Self {
        match error {
            StarError::Network(error) => error,
            other => Self::Backend(Box::new(other)),
        }
    }
}
