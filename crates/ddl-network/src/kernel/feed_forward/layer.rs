//! The feed-forward block with its weights in the layout of the kernels, and one block of its hidden units.

use crate::kernel::affine::Affine;
use crate::kernel::columns::{MatrixColumns, MatrixColumnsMut};
use crate::kernel::feed_forward::dropout::UnitDecisions;
use crate::kernel::product::{BLOCK, End, Start, multiply};
use ddl_simd::{Dispatch, Simd};

/// Number of rows whose hidden activations of one block of units are computed together. They stay in the first-level
/// cache.
pub(super) const ROWS_AT_ONCE: usize = 64;

/// y = W2 d(relu(W1 x + b1)) + b2, with dropout d.
///
/// The hidden activations are not stored: 32 of them are computed for a few rows and used at once. The backward pass
/// computes them again.
#[derive(Clone, Debug)]
pub(crate) struct FeedForward {
    pub(super) before: Affine,
    pub(super) after: Affine,
    pub(in crate::kernel) dispatch: Dispatch,
}

impl FeedForward {
    /// A block whose weights are all 0, of any width and hidden width.
    pub(crate) fn zeros(width: usize, hidden: usize) -> Self {
        Self { before: Affine::new(width, hidden), after: Affine::new(hidden, width), dispatch: Dispatch::detect() }
    }

    /// Replaces the weights: W1 `[hidden, width]`, b1 `[hidden]`, W2 `[width, hidden]`, b2 `[width]`, row-major.
    pub(crate) fn update(&mut self, [w1, b1, w2, b2]: [&[f32]; 4]) {
        self.before.update(w1, b1);
        self.after.update(w2, b2);
    }

    pub(super) fn width(&self) -> usize {
        self.before.inputs
    }

    pub(super) fn hidden(&self) -> usize {
        self.before.outputs
    }

    /// Number of blocks of hidden units.
    pub(super) fn units(&self) -> usize {
        self.hidden().div_ceil(BLOCK)
    }

    /// Number of hidden units in a block.
    pub(super) fn units_of(&self, block: usize) -> usize {
        BLOCK.min(self.hidden() - block * BLOCK)
    }

    /// d(relu(W1 x + b1)) of a block of units. `decisions` come with the index of the first row.
    /// `x` `[rows, width]` -> `hidden` `[rows, 32]`, overwritten.
    #[inline(always)]
    pub(super) fn activate<S: Simd, const R: usize, const V: usize>(
        &self,
        simd: S,
        block: usize,
        x: &[f32],
        decisions: Option<(&UnitDecisions, usize)>,
        hidden: &mut [f32],
    ) {
        let x = MatrixColumns::whole(x, self.width());
        let start = Start::Row(&self.before.bias[2 * block..]);
        let mut columns = MatrixColumnsMut::whole(hidden, BLOCK);
        multiply::<S, R, V>(simd, x, self.before.transposed.block(block), (start, End::Relu), &mut columns);
        if let Some((decisions, first)) = decisions {
            decisions.apply(simd, hidden, first, block);
        }
    }
}
