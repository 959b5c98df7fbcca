//! One block of hidden units for a few rows.

use super::block::{Block, BlockRows, PARTS, tile};
use super::product::{multiply, store_tile};
use super::weights::Unit;
use ddl_simd::Simd;

/// relu(W1 x + b1) of a block of units, for R rows from `row`.
#[inline(always)]
pub(super) fn activate<S: Simd, const R: usize, const V: usize>(
    simd: S,
    unit: Unit<'_>,
    x: &BlockRows,
    row: usize,
    hidden: &mut [Block; R],
) {
    for part in (0..PARTS).step_by(V) {
        let mut sum = [[simd.splat(0.0); V]; R];
        for r in 0..R {
            for v in 0..V {
                sum[r][v] = simd.load(unit.b1().part(part + v));
            }
        }
        for column in 0..unit.columns() {
            let x = tile(x.column(column), row);
            sum = multiply(simd, sum, x, unit.w1_transposed(column), part);
        }
        for r in 0..R {
            for v in 0..V {
                sum[r][v] = simd.max(simd.splat(0.0), sum[r][v]);
            }
        }
        store_tile(simd, &sum, hidden, part);
    }
}

/// Replaces activations by the gradients of the inputs of `ReLU`: W2^T gy times `scale`, or 0 if the activation is 0.
#[inline(always)]
pub(super) fn deactivate<S: Simd, const R: usize, const V: usize>(
    simd: S,
    unit: Unit<'_>,
    gy: &BlockRows,
    row: usize,
    scale: f32,
    hidden: &[Block; R],
    gradient: &mut [Block; R],
) {
    for part in (0..PARTS).step_by(V) {
        let mut sum = [[simd.splat(0.0); V]; R];
        for column in 0..unit.columns() {
            let gy = tile(gy.column(column), row);
            sum = multiply(simd, sum, gy, unit.w2(column), part);
        }
        for r in 0..R {
            for v in 0..V {
                let scaled = simd.mul(sum[r][v], simd.splat(scale));
                let hidden = simd.load(hidden[r].part(part + v));
                sum[r][v] = simd.zero_unless_positive(hidden, scaled);
            }
        }
        store_tile(simd, &sum, gradient, part);
    }
}
