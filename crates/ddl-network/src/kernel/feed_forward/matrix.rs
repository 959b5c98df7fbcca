//! The block on a matrix unit: products of 32 rows and 32 hidden units.

mod backward;
mod forward;

use super::block::{BLOCK, Block, Panel};
use super::weights::BlockWeights;
pub(super) use backward::{RowFactors, SetRowFactors, UnitBackward};
use ddl_simd::{Dispatch, LeftFactor, MatrixDispatch, MatrixKernel, MatrixUnit, Pieces, RightFactor, Simd};
pub(super) use forward::UnitForward;

/// The weights as factors of products, in the order of [`BlockWeights`].
#[derive(Clone, Debug)]
pub(super) struct Factors {
    pub(super) unit: MatrixDispatch,
    w1: Vec<RightFactor>,
    w1_transposed: Vec<RightFactor>,
    w2: Vec<RightFactor>,
    w2_transposed: Vec<RightFactor>,
}

impl Factors {
    /// `None` without a matrix unit.
    pub(super) fn new(weights: &BlockWeights, dispatch: Dispatch) -> Option<Self> {
        let unit = dispatch.matrix_unit()?;
        let factors = |panels: &[Panel]| {
            let mut factors = vec![RightFactor::ZERO; panels.len()];
            unit.run(Split {
                panels,
                factors: &mut factors,
            });
            factors
        };
        Some(Self {
            unit,
            w1: factors(&weights.w1),
            w1_transposed: factors(&weights.w1_transposed),
            w2: factors(&weights.w2),
            w2_transposed: factors(&weights.w2_transposed),
        })
    }
}

struct Split<'a> {
    panels: &'a [Panel],
    factors: &'a mut [RightFactor],
}

impl MatrixKernel for Split<'_> {
    #[inline(always)]
    fn run<U: MatrixUnit>(self, unit: U) {
        for (panel, factor) in self.panels.iter().zip(self.factors) {
            for pair in 0..BLOCK / 2 {
                let rows = [&panel[2 * pair], &panel[2 * pair + 1]];
                set_rows(unit, factor, pair, [split(unit, rows[0]), split(unit, rows[1])]);
            }
        }
    }
}

/// The pieces of both halves of a row.
type RowPieces<U> = [Pieces<U>; 2];

#[inline(always)]
fn split<U: MatrixUnit>(unit: U, row: &Block) -> RowPieces<U> {
    let simd = unit.simd();
    [unit.pieces(simd.load(row.part(0))), unit.pieces(simd.load(row.part(1)))]
}

#[inline(always)]
fn set_rows<U: MatrixUnit>(unit: U, factor: &mut RightFactor, pair: usize, [even, odd]: [RowPieces<U>; 2]) {
    for half in 0..2 {
        factor.set_rows(unit, pair, half, [&even[half], &odd[half]]);
    }
}

#[inline(always)]
fn left_factor<U: MatrixUnit>(unit: U, panel: &Panel, factor: &mut LeftFactor) {
    for (row, numbers) in panel.iter().enumerate() {
        let [low, high] = split(unit, numbers);
        factor.set_row(unit, row, [&low, &high]);
    }
}

/// Block `column` of at most 32 rows of `width` numbers, padded with zeros.
#[inline(always)]
fn load_rows(rows: &[f32], width: usize, column: usize, panel: &mut Panel) {
    let (found, padding) = panel.split_at_mut(rows.len() / width);
    for (block, row) in found.iter_mut().zip(rows.chunks_exact(width)) {
        let piece = &row[column * BLOCK..];
        *block = Block::padded(&piece[..piece.len().min(BLOCK)]);
    }
    padding.fill(Block::ZERO);
}
