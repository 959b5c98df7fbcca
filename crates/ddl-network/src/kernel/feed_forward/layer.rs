//! The weights of the block, as its passes read them.

use super::bf16::Squares;
use super::weights::BlockWeights;
use crate::Precision;
#[cfg(test)]
use ddl_simd::InstructionSet;
use ddl_simd::{Dispatch, PairDispatch};

/// y = W2 d(relu(W1 x + b1)) + b2, with dropout d.
///
/// A row of `hidden` activations is never stored: 32 of them are computed for a few rows, used, and forgotten; the
/// backward pass computes them again.
#[derive(Clone, Debug)]
pub(crate) struct FeedForward {
    pub(super) weights: BlockWeights,
    pub(super) rounded: Option<Squares>,
    pub(super) dispatch: Dispatch,
    pub(super) pair_dispatch: PairDispatch,
}

impl FeedForward {
    /// A block whose weights are all 0. Any width and hidden width will do; both are padded to multiples of 32.
    pub(crate) fn zeros(width: usize, hidden: usize) -> Self {
        Self {
            weights: BlockWeights::new(width, hidden),
            rounded: None,
            dispatch: Dispatch::detect(),
            pair_dispatch: PairDispatch::detect(),
        }
    }

    /// Arranges weights for the kernels, in bf16 for the forward pass alone.
    /// W1 `[hidden, width]`, b1 `[hidden]`, W2 `[width, hidden]`, b2 `[width]`, by rows.
    pub(crate) fn update(&mut self, weights: [&[f32]; 4], precision: Precision) {
        self.weights.update(weights);
        self.rounded = (precision == Precision::Bf16)
            .then(|| Squares::round(&self.weights, self.pair_dispatch));
    }

    /// The same with other instructions than the fastest, bf16 emulated; `None` when the machine lacks them.
    #[cfg(test)]
    pub(in crate::kernel) fn with_instructions(mut self, set: InstructionSet) -> Option<Self> {
        self.dispatch = Dispatch::new(set)?;
        self.pair_dispatch = PairDispatch::emulated(self.dispatch);
        Some(self)
    }
}
