//! The feed-forward block of an encoder layer: two affine maps, `ReLU` and dropout between them.

mod backward;
mod bf16;
mod block;
mod block_rows;
mod dropout;
mod forward;
mod gradients;
mod hidden;
mod layer;
mod product;
#[cfg(test)]
mod tests;
mod tile;
mod weights;

pub(crate) use gradients::Gradients;
pub(crate) use layer::FeedForward;

use std::ops::DerefMut;

use super::dropout::Dropout;

impl FeedForward {
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
