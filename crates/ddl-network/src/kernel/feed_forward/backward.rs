//! The backward pass, parallel over groups of hidden units. The gradients of a unit's weights belong to a single group.
//! So only gx, which is small (`rows * width` for each group), has to be summed over the groups. The groups, and so the
//! sums, do not depend on the number of threads.

use std::ops::DerefMut;

use super::block::{BLOCK, Block, BlockRows, Panel, ROWS, tile_mut};
use super::dropout::UnitDecisions;
use super::hidden::{activate, deactivate};
use super::layer::FeedForward;
use super::product::{add_product, add_transposed_product, sum_of_rows};
use super::weights::BlockWeights;
use crate::kernel::dropout::Dropout;
use crate::kernel::threads::each;
use ddl_simd::{Simd, TiledKernel};

const GROUPS: usize = 8;
/// Number of rows after which the groups' gx are added: these rows fit the second-level cache.
const SPAN: usize = 512;
/// Number of rows whose hidden activations of one block are kept, in the first-level cache, for the weights' gradients.
const KEPT: usize = 64;

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
        grads: &mut Gradients<impl DerefMut<Target = [f32]>>,
    ) {
        let weights = &self.weights;
        let BlockWeights {
            width,
            hidden,
            columns,
            units,
            ..
        } = *weights;
        assert_eq!(x.len() % width, 0, "x is not made of rows of {width}");
        assert_eq!(x.len(), gy.len(), "entries of x and gy");
        assert_eq!(x.len(), gx.len(), "entries of x and gx");
        grads.check(width, hidden);
        let decisions = dropout.and_then(|dropout| UnitDecisions::new(dropout, x.len() / width));

        for row in gy.chunks_exact(width) {
            for (sum, term) in grads.b2.iter_mut().zip(row) {
                *sum += term;
            }
        }
        let group = units.div_ceil(GROUPS);
        let rows = (x.len() / width).min(SPAN).next_multiple_of(ROWS);
        let parts = grads.parts(width, group).into_iter();
        let mut parts: Vec<_> = parts.map(|part| (part, Scratch::new(rows, columns))).collect();
        let pieces = x.chunks(SPAN * width).zip(gy.chunks(SPAN * width));
        for (span, ((x, gy), gx)) in pieces.zip(gx.chunks_mut(SPAN * width)).enumerate() {
            let x = BlockRows::padded(x, width);
            let gy = BlockRows::padded(gy, width);
            let groups: Vec<_> = parts.iter_mut().enumerate().collect();
            let work = 5 * x.rows() * width * hidden;
            each(groups, work, |(g, (part, scratch)), (): &mut ()| {
                self.dispatch.run(UnitsBackward {
                    weights,
                    decisions: decisions.as_ref(),
                    first: span * SPAN,
                    units: g * group,
                    x: &x,
                    gy: &gy,
                    scratch,
                    part,
                });
            });
            gx.fill(0.0);
            let work = gx.len() * parts.len();
            let pieces: Vec<_> = gx.chunks_mut(KEPT * width).enumerate().collect();
            each(pieces, work, |(piece, gx), (): &mut ()| {
                for (_, scratch) in &parts {
                    scratch.gx.add_to(piece * KEPT, gx, width);
                }
            });
        }
    }
}

struct Scratch {
    gx: BlockRows,
    /// Gradients of W1 summed over a span, for one block of hidden units; rows are hidden units.
    w1: Vec<Panel>,
    /// Gradients of W2 likewise; rows are entries of y.
    w2: Vec<Panel>,
    hidden: Vec<Block>,
    gradient: Vec<Block>,
}

impl Scratch {
    fn new(rows: usize, columns: usize) -> Self {
        Self {
            gx: BlockRows::zeros(rows, columns),
            w1: vec![[Block::ZERO; BLOCK]; columns],
            w2: vec![[Block::ZERO; BLOCK]; columns],
            hidden: vec![Block::ZERO; KEPT],
            gradient: vec![Block::ZERO; KEPT],
        }
    }
}

struct UnitsBackward<'a, 'b> {
    weights: &'a BlockWeights,
    decisions: Option<&'a UnitDecisions>,
    first: usize,
    units: usize,
    x: &'a BlockRows,
    gy: &'a BlockRows,
    scratch: &'a mut Scratch,
    part: &'a mut UnitGradients<'b>,
}

impl TiledKernel for UnitsBackward<'_, '_> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(self, simd: S) {
        let Self {
            weights,
            decisions,
            first,
            units,
            x,
            gy,
            scratch,
            part,
        } = self;
        let Scratch {
            gx,
            w1,
            w2,
            hidden,
            gradient,
        } = scratch;
        let scale = match decisions {
            Some(decisions) => decisions.scale,
            None => 1.0,
        };
        for column in 0..weights.columns {
            gx.column_mut(column).fill(Block::ZERO);
        }
        for (u, b1) in part.b1.chunks_mut(BLOCK).enumerate() {
            let unit = units + u;
            let of_unit = weights.unit(unit);
            w1.fill([Block::ZERO; BLOCK]);
            w2.fill([Block::ZERO; BLOCK]);
            for start in (0..x.rows()).step_by(KEPT) {
                let count = KEPT.min(x.rows() - start);
                for r in (0..count).step_by(R) {
                    let row = start + r;
                    let hidden = tile_mut::<R>(hidden, r);
                    let gradient = tile_mut::<R>(gradient, r);
                    activate::<S, R, V>(simd, of_unit, x, row, hidden);
                    if let Some(decisions) = decisions {
                        decisions.apply(simd, hidden, first + row, unit);
                    }
                    deactivate::<S, R, V>(simd, of_unit, gy, row, scale, hidden, gradient);
                    for column in 0..weights.columns {
                        let gx = tile_mut(gx.column_mut(column), row);
                        add_product::<S, R, V>(simd, gx, gradient, of_unit.w1(column));
                    }
                }
                let (hidden, gradient) = (&hidden[..count], &gradient[..count]);
                sum_of_rows::<S, V>(simd, gradient).add_to(b1);
                for column in 0..weights.columns {
                    let x = &x.column(column)[start..][..count];
                    let gy = &gy.column(column)[start..][..count];
                    add_transposed_product::<S, R, V>(simd, &mut w1[column], gradient, x);
                    add_transposed_product::<S, R, V>(simd, &mut w2[column], gy, hidden);
                }
            }
            for column in 0..weights.columns {
                let rows = part.w1.chunks_exact_mut(weights.width).skip(u * BLOCK);
                for (row, sums) in rows.zip(&w1[column]) {
                    sums.add_to(&mut row[column * BLOCK..]);
                }
                let rows = part.w2.iter_mut().skip(column * BLOCK);
                for (row, sums) in rows.zip(&w2[column]) {
                    sums.add_to(&mut row[u * BLOCK..]);
                }
            }
        }
    }
}

/// Gradients of the weights, with the shapes of [`FeedForward::update`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gradients<N = Vec<f32>> {
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
impl Gradients {
    pub(crate) fn zeros(width: usize, hidden: usize) -> Self {
        Self {
            w1: vec![0.0; hidden * width],
            b1: vec![0.0; hidden],
            w2: vec![0.0; width * hidden],
            b2: vec![0.0; width],
        }
    }
}

impl<N: DerefMut<Target = [f32]>> Gradients<N> {
    pub(super) fn check(&self, width: usize, hidden: usize) {
        let found = [&self.w1, &self.b1, &self.w2, &self.b2].map(|part| part.len());
        let expected = [hidden * width, hidden, width * hidden, width];
        assert_eq!(found, expected, "entries of the gradients of W1, b1, W2, b2");
    }

    /// Parts of `units` blocks of hidden units each.
    pub(super) fn parts(&mut self, width: usize, units: usize) -> Vec<UnitGradients<'_>> {
        let hidden = self.b1.len();
        let size = units * BLOCK;
        let w1 = self.w1.chunks_mut(size * width);
        let b1 = self.b1.chunks_mut(size);
        let mut parts: Vec<_> = w1
            .zip(b1)
            .map(|(w1, b1)| UnitGradients { w1, b1, w2: vec![] })
            .collect();
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
