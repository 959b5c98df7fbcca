//! Random numbers: each purpose has its own stream, which does not depend on how many numbers other purposes drew.

use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

/// The purpose of a stream of random numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Initial weights.
    Weights,
    /// Order of the training windows.
    BatchOrder,
    /// Rotation angles.
    Rotation,
    /// Noise vectors and dropout seeds of training steps.
    Step,
    /// Noise vectors of forecasts.
    Forecast,
    /// Initial weights of the proposal network.
    ProposalWeights,
    /// Batches and augmentation of the proposal network.
    ProposalStep,
}

/// The stream of a stage; `index` selects one step of the stage.
pub fn stream(seed: u64, stage: Stage, index: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(((stage as u64) << 48) | index);
    rng
}
