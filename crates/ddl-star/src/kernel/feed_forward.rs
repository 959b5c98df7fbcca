//! The feed-forward block of an encoder layer: two affine maps, `ReLU` and dropout between them.

mod backward;
mod bf16;
mod block;
mod block_rows;
mod dropout;
mod forward;
mod gradients;
mod hidden;
mod product;
#[cfg(test)]
mod tests;
mod weights;

pub(crate) use gradients::Gradients;

use std::ops::DerefMut;

use super::dropout::Dropout;
#[cfg(test)]
use super::instruction_set::InstructionSet;
use super::instruction_set::{Dispatch, PairDispatch};
use crate::Precision;
use bf16::Squares;
use weights::Weights;

/// y = W2 d(relu(W1 x + b1)) + b2, with dropout d.
///
/// A row of `hidden` activations is never stored: 32 of them are computed for a few rows, used, and forgotten; the
/// backward pass computes them again.
#[derive(Clone, Debug)]
pub(crate) struct FeedForward {
    weights: Weights,
    /// For the forward pass in bf16.
    rounded: Option<Squares>,
    dispatch: Dispatch,
    pair_dispatch: PairDispatch,
}

impl FeedForward {
    /// A block whose weights are all 0. Any width and hidden width will do; both are padded to multiples of 32.
    ///
    /// # Panics
    /// When a width is 0.
    pub(crate) fn zeros(width: usize, hidden: usize) -> Self {
        Self {
            weights: Weights::new(width, hidden),
            rounded: None,
            dispatch: Dispatch::detect(),
            pair_dispatch: PairDispatch::detect(),
        }
    }

    /// Arranges the weights of libtorch's layers for the kernels, in bf16 for the forward pass alone.
    ///
    /// # Shapes
    /// W1 `[hidden, width]`, b1 `[hidden]`, W2 `[width, hidden]`, b2 `[width]`, by rows.
    ///
    /// # Panics
    /// When a slice has another length.
    pub(crate) fn update(&mut self, weights: [&[f32]; 4], precision: Precision) {
        self.weights.update(weights);
        self.rounded = (precision == Precision::Bf16)
            .then(|| Squares::round(&self.weights, self.pair_dispatch));
    }

    /// Both at once, in `f32`.
    #[cfg(test)]
    pub(crate) fn pack(
        w1: &[f32],
        b1: &[f32],
        w2: &[f32],
        b2: &[f32],
        width: usize,
        hidden: usize,
    ) -> Self {
        let mut block = Self::zeros(width, hidden);
        block.update([w1, b1, w2, b2], Precision::F32);
        block
    }

    /// The same with other instructions than the fastest, bf16 emulated; `None` when the machine lacks them.
    #[cfg(test)]
    pub(super) fn with_instructions(mut self, set: InstructionSet) -> Option<Self> {
        self.dispatch = Dispatch::new(set)?;
        self.pair_dispatch = PairDispatch::Emulated(self.dispatch);
        Some(self)
    }

    /// y for every row of x.
    ///
    /// # Shapes
    /// `x` `[rows, width]` -> `y` `[rows, width]`, overwritten.
    ///
    /// # Panics
    /// When `y` is not as long as `x` or this is no multiple of the width; unless 0 <= p < 1.
    ///
    /// # Numerics
    /// For finite sums, an entry differs from the exact one by at most (width + hidden + 8) 2^-24 times the same formula
    /// with the absolute values of all its terms and without `ReLU`. It does not depend on the number of threads nor on the other rows.
    ///
    /// In bf16 x, W1, W2 and the hidden activations are rounded to it first, each by at most 2^-9 of itself; sums and biases
    /// are `f32`, and what is said above holds of the formula with rounded numbers.
    pub(crate) fn forward(&self, x: &[f32], dropout: Option<Dropout>, y: &mut [f32]) {
        forward::run(self, x, dropout, y);
    }

    /// The derivative with respect to x, and those with respect to the weights added to `grads`.
    ///
    /// With the same dropout as in [`Self::forward`], whose decisions are made again.
    ///
    /// # Shapes
    /// `x`, `gy` `[rows, width]` -> `gx` `[rows, width]`, overwritten.
    ///
    /// # Panics
    /// As in [`Self::forward`]; when `grads` was made for other widths; in bf16.
    ///
    /// # Numerics
    /// An entry differs from the exact one by at most (width + hidden + 16) 2^-24 (for gx), (width + rows + 16) 2^-24 (for
    /// the others) times the formula with the absolute values of all its terms; where W1 x + b1 is 0 to rounding the
    /// derivative of `ReLU` may be taken as 0 or 1. Nothing depends on the number of threads.
    pub(crate) fn backward(
        &self,
        x: &[f32],
        gy: &[f32],
        dropout: Option<Dropout>,
        gx: &mut [f32],
        grads: &mut Gradients<impl DerefMut<Target = [f32]>>,
    ) {
        backward::run(self, [x, gy], dropout, gx, grads);
    }
}
