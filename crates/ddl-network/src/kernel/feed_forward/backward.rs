//! The backward pass, parallel over groups of hidden units. The gradients of a unit's weights belong to a single group.
//! So only gx, which is small (`rows * width` for each group), has to be summed over the groups. The groups, and so the
//! sums, do not depend on the number of threads.

use crate::kernel::buffer::{Buffer, add_to};
use crate::kernel::columns::{MatrixColumns, MatrixColumnsMut, load, store};
use crate::kernel::dropout::Dropout;
use crate::kernel::feed_forward::dropout::UnitDecisions;
use crate::kernel::feed_forward::layer::{FeedForward, ROWS_AT_ONCE};
use crate::kernel::product::{BLOCK, End, Start, add_transposed_product, multiply, sum_of_rows};
use crate::kernel::threads::run_each;
use ddl_simd::{LANES, Simd, TiledKernel};
use fearless_simd::prelude::*;
use std::ops::DerefMut;

const GROUPS: usize = 8;
/// Number of rows after which the groups' gx are added: these rows fit the second-level cache.
const SPAN: usize = 512;

impl FeedForward {
    /// The gradient of x; the gradients of the weights are added to `grads`.
    /// `x`, `gy` `[rows, width]` -> `gx` `[rows, width]`, overwritten.
    ///
    /// `dropout` must be that of [`Self::forward`]; its decisions are computed again.
    ///
    /// The error of an entry is at most a factor times the formula with the absolute values of all its terms. The
    /// factor is (width + hidden + 16) 2^-24 for gx and (width + rows + 16) 2^-24 for the others. If W1 x + b1 is 0 up
    /// to rounding, the derivative of `ReLU` may be 0 or 1. Results do not depend on the number of threads.
    pub(crate) fn backward(
        &self,
        x: &[f32],
        gy: &[f32],
        dropout: Option<Dropout>,
        gx: &mut [f32],
        grads: &mut LayerGradients<impl DerefMut<Target = [f32]>>,
    ) {
        let (width, hidden) = (self.width(), self.hidden());
        assert_eq!(x.len() % width, 0, "x is not made of rows of {width}");
        assert_eq!(x.len(), gy.len(), "entries of x and gy");
        assert_eq!(x.len(), gx.len(), "entries of x and gx");
        grads.check(width, hidden);
        let decisions = dropout.and_then(|dropout| UnitDecisions::new(dropout, x.len() / width));

        for row in gy.chunks_exact(width) {
            add_to(&mut grads.b2, row);
        }
        let group = self.units().div_ceil(GROUPS);
        let numbers = x.len().min(SPAN * width);
        let parts = grads.parts(width, group).into_iter();
        let mut parts: Vec<_> = parts.map(|part| (part, Scratch::new(numbers, width))).collect();
        let pieces = x.chunks(SPAN * width).zip(gy.chunks(SPAN * width));
        for (span, ((x, gy), gx)) in pieces.zip(gx.chunks_mut(SPAN * width)).enumerate() {
            let jobs = parts.iter_mut().enumerate().map(|(g, (part, scratch))| UnitsBackward {
                layer: self,
                decisions: decisions.as_ref(),
                first: span * SPAN,
                blocks: g * group,
                x,
                gy,
                scratch,
                part,
            });
            run_each(self.dispatch, jobs, 5 * x.len() * hidden);
            gx.fill(0.0);
            for (_, scratch) in &parts {
                add_to(gx, &scratch.gx);
            }
        }
    }
}

/// Sums of a group over a span of rows.
struct Scratch {
    gx: Buffer,
    /// Gradients of W1 for one block of hidden units, `[32, width]`.
    w1: Buffer,
    /// Gradients of W2 likewise, `[width, 32]`.
    w2: Buffer,
}

impl Scratch {
    fn new(numbers: usize, width: usize) -> Self {
        Self { gx: Buffer::any(numbers), w1: Buffer::any(BLOCK * width), w2: Buffer::any(width * BLOCK) }
    }
}

struct UnitsBackward<'a, 'b> {
    layer: &'a FeedForward,
    decisions: Option<&'a UnitDecisions>,
    first: usize,
    /// The first block of hidden units.
    blocks: usize,
    x: &'a [f32],
    gy: &'a [f32],
    scratch: &'a mut Scratch,
    part: &'a mut UnitGradients<'b>,
}

impl TiledKernel for UnitsBackward<'_, '_> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(self, simd: S) {
        let (layer, width) = (self.layer, self.layer.width());
        let Scratch { gx, w1, w2 } = self.scratch;
        let gx = &mut gx[..self.x.len()];
        gx.fill(0.0);
        let [mut hidden, mut gradient] = [0; 2].map(|_| Buffer::any(ROWS_AT_ONCE * BLOCK));
        for (b, b1) in self.part.b1.chunks_mut(BLOCK).enumerate() {
            let (block, count) = (self.blocks + b, b1.len());
            w1.fill(0.0);
            w2.fill(0.0);
            let pieces = self.x.chunks(ROWS_AT_ONCE * width).zip(self.gy.chunks(ROWS_AT_ONCE * width));
            let pieces = pieces.zip(gx.chunks_mut(ROWS_AT_ONCE * width));
            for (piece, ((x, gy), gx)) in pieces.enumerate() {
                let rows = x.len() / width;
                let (hidden, gradient) = (&mut hidden[..rows * BLOCK], &mut gradient[..rows * BLOCK]);
                let decisions = self.decisions.map(|decisions| (decisions, self.first + piece * ROWS_AT_ONCE));
                layer.activate::<S, R, V>(simd, block, x, decisions, hidden);
                let gy = MatrixColumns::whole(gy, width);
                let w2_of_block = layer.after.weight.block(block);
                let mut of_hidden = MatrixColumnsMut::whole(gradient, BLOCK);
                multiply::<S, R, V>(simd, gy, w2_of_block, (Start::Zero, End::Unchanged), &mut of_hidden);
                let scale = decisions.map_or(1.0, |(decisions, _)| decisions.scale);
                deactivate(simd, hidden, scale, gradient);
                let gradient = MatrixColumns::first(gradient, BLOCK, count);
                multiply::<S, R, V>(
                    simd,
                    gradient,
                    layer.before.weight.rows(block * BLOCK, count),
                    (Start::There, End::Unchanged),
                    &mut MatrixColumnsMut::whole(gx, width),
                );
                sum_of_rows(simd, gradient, b1);
                let (x, hidden) = (MatrixColumns::whole(x, width), MatrixColumns::whole(hidden, BLOCK));
                add_transposed_product::<S, R, V>(simd, gradient, count, x, width, &mut w1[..count * width]);
                add_transposed_product::<S, R, V>(simd, gy, width, hidden, BLOCK, w2);
            }
            let rows = self.part.w1.chunks_exact_mut(width).skip(b * BLOCK);
            for (row, sums) in rows.zip(w1.chunks_exact(width)) {
                add_to(row, sums);
            }
            for (row, sums) in self.part.w2.iter_mut().zip(w2.chunks_exact(BLOCK)) {
                add_to(&mut row[b * BLOCK..], sums);
            }
        }
    }
}

/// Replaces gradients of activations by those of the inputs of `ReLU`: multiplied by `scale`, or 0 if the activation is
/// 0.
#[inline(always)]
fn deactivate<S: Simd>(simd: S, hidden: &[f32], scale: f32, gradient: &mut [f32]) {
    let scale = simd.splat(scale);
    for first in (0..gradient.len()).step_by(LANES) {
        let scaled = load(simd, gradient, first) * scale;
        let changed = load(simd, hidden, first).simd_le(0.0).select(simd.splat(0.0), scaled);
        store(simd, changed, gradient, first);
    }
}

/// Gradients of the weights, with the shapes of [`FeedForward::update`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LayerGradients<N = Vec<f32>> {
    /// `[hidden, width]`, by rows.
    pub(crate) w1: N,
    /// `[hidden]`.
    pub(crate) b1: N,
    /// `[width, hidden]`, by rows.
    pub(crate) w2: N,
    /// `[width]`.
    pub(crate) b2: N,
}

#[cfg(test)]
impl LayerGradients {
    pub(crate) fn zeros(width: usize, hidden: usize) -> Self {
        Self {
            w1: vec![0.0; hidden * width],
            b1: vec![0.0; hidden],
            w2: vec![0.0; width * hidden],
            b2: vec![0.0; width],
        }
    }
}

impl<N: DerefMut<Target = [f32]>> LayerGradients<N> {
    pub(super) fn check(&self, width: usize, hidden: usize) {
        let lengths = [&self.w1, &self.b1, &self.w2, &self.b2].map(|part| part.len());
        let expected = [hidden * width, hidden, width * hidden, width];
        assert_eq!(lengths, expected, "entries of the gradients of W1, b1, W2, b2");
    }

    /// Parts of `units` blocks of hidden units each.
    pub(super) fn parts(&mut self, width: usize, units: usize) -> Vec<UnitGradients<'_>> {
        let hidden = self.b1.len();
        let size = units * BLOCK;
        let w1 = self.w1.chunks_mut(size * width);
        let b1 = self.b1.chunks_mut(size);
        let mut parts: Vec<_> = w1.zip(b1).map(|(w1, b1)| UnitGradients { w1, b1, w2: vec![] }).collect();
        for row in self.w2.chunks_exact_mut(hidden) {
            for (part, piece) in parts.iter_mut().zip(row.chunks_mut(size)) {
                part.w2.push(piece);
            }
        }
        parts
    }
}

pub(super) struct UnitGradients<'a> {
    pub(super) w1: &'a mut [f32],
    pub(super) b1: &'a mut [f32],
    pub(super) w2: Vec<&'a mut [f32]>,
}
