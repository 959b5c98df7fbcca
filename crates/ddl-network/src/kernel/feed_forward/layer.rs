//! The feed-forward block with its weights in the layout of the kernels.

use super::weights::BlockWeights;
use ddl_simd::Dispatch;
#[cfg(test)]
use ddl_simd::InstructionSet;

/// y = W2 d(relu(W1 x + b1)) + b2, with dropout d.
///
/// The hidden activations are not stored: 32 of them are computed for a few rows and used at once. The backward pass
/// computes them again.
#[derive(Clone, Debug)]
pub(crate) struct FeedForward {
    pub(super) weights: BlockWeights,
    pub(super) dispatch: Dispatch,
}

impl FeedForward {
    /// A block whose weights are all 0. Any width and hidden width are allowed; both are padded to multiples of 32.
    pub(crate) fn zeros(width: usize, hidden: usize) -> Self {
        Self {
            weights: BlockWeights::new(width, hidden),
            dispatch: Dispatch::detect(),
        }
    }

    /// Replaces the weights: W1 `[hidden, width]`, b1 `[hidden]`, W2 `[width, hidden]`, b2 `[width]`, row-major.
    pub(crate) fn update(&mut self, weights: [&[f32]; 4]) {
        self.weights.update(weights);
    }

    /// The same with this instruction set; `None` if the processor does not support it.
    #[cfg(test)]
    pub(in crate::kernel) fn with_instructions(mut self, set: InstructionSet) -> Option<Self> {
        self.dispatch = Dispatch::new(set)?;
        Some(self)
    }
}
