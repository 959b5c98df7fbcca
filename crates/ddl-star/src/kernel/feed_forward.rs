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

use super::dropout::Dropout;
#[cfg(test)]
use super::instruction_set::InstructionSet;
use super::instruction_set::{Dispatch, PairDispatch};
use crate::Precision;
use bf16::PairPanel;
use weights::{Sizes, Weights};

/// y = W2 d(relu(W1 x + b1)) + b2, with dropout d.
///
/// A row of `hidden` activations is never stored: 32 of them are computed for a few rows, used, and forgotten; the
/// backward pass computes them again.
#[derive(Clone, Debug)]
pub(crate) struct FeedForward {
    arithmetic: Arithmetic,
}

/// The weights, and the instructions that take them.
#[derive(Clone, Debug)]
enum Arithmetic {
    F32(Weights, Dispatch),
    Bf16(Weights<PairPanel>, PairDispatch),
}

impl FeedForward {
    /// Arranges the weights of libtorch's layers for the kernels.
    ///
    /// # Shapes
    /// `w1` `[hidden, width]`, `b1` `[hidden]`, `w2` `[width, hidden]`, `b2` `[width]`, by rows. Any width and hidden width
    /// will do; both are padded to multiples of 32.
    ///
    /// # Panics
    /// When a width is 0 or a slice has another length.
    pub(crate) fn pack(
        precision: Precision,
        w1: &[f32],
        b1: &[f32],
        w2: &[f32],
        b2: &[f32],
        width: usize,
        hidden: usize,
    ) -> Self {
        let weights = Weights::new([w1, b1, w2, b2], width, hidden);
        let arithmetic = match precision {
            Precision::F32 => Arithmetic::F32(weights, Dispatch::detect()),
            Precision::Bf16 => {
                let dispatch = PairDispatch::detect();
                let weights = weights.map(|squares| bf16::round_panels(dispatch, squares));
                Arithmetic::Bf16(weights, dispatch)
            }
        };
        Self { arithmetic }
    }

    fn sizes(&self) -> Sizes {
        match &self.arithmetic {
            Arithmetic::F32(weights, _) => weights.sizes,
            Arithmetic::Bf16(weights, _) => weights.sizes,
        }
    }

    /// The same with other instructions than the fastest, bf16 emulated; `None` when the machine lacks them.
    #[cfg(test)]
    pub(super) fn with_instructions(mut self, set: InstructionSet) -> Option<Self> {
        let dispatch = Dispatch::new(set)?;
        match &mut self.arithmetic {
            Arithmetic::F32(_, of_f32) => *of_f32 = dispatch,
            Arithmetic::Bf16(_, of_pairs) => *of_pairs = PairDispatch::Emulated(dispatch),
        }
        Some(self)
    }

    /// The arithmetic and its instructions, for messages.
    #[cfg(test)]
    pub(super) fn instructions(&self) -> String {
        match &self.arithmetic {
            Arithmetic::F32(_, dispatch) => format!("f32 by {dispatch:?}"),
            Arithmetic::Bf16(_, dispatch) => format!("bf16 by {dispatch:?}"),
        }
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
    /// As in [`Self::forward`]; when `grads` was made for other widths.
    ///
    /// # Numerics
    /// An entry differs from the exact one by at most (width + hidden + 16) 2^-24 (for gx), (width + rows + 16) 2^-24 (for
    /// the others) times the formula with the absolute values of all its terms; where W1 x + b1 is 0 to rounding the
    /// derivative of `ReLU` may be taken as 0 or 1. Nothing depends on the number of threads.
    ///
    /// In bf16 gy is rounded as well, and what comes back to W1 x + b1 for gx and W1; sums are `f32`, as are the derivatives
    /// with respect to b1 and b2 throughout.
    pub(crate) fn backward(
        &self,
        x: &[f32],
        gy: &[f32],
        dropout: Option<Dropout>,
        gx: &mut [f32],
        grads: &mut Gradients,
    ) {
        backward::run(self, [x, gy], dropout, gx, grads);
    }
}
