//! The forward pass on a matrix unit.

use super::{Factors, left_factor, load_rows};
use crate::kernel::feed_forward::block::{BLOCK, Block, Panel};
use crate::kernel::feed_forward::dropout::UnitDecisions;
use crate::kernel::feed_forward::weights::BlockWeights;
use ddl_simd::{LeftFactor, MatrixKernel, MatrixUnit, Simd, Start};

pub(in crate::kernel::feed_forward) struct UnitForward<'a> {
    pub(in crate::kernel::feed_forward) weights: &'a BlockWeights,
    pub(in crate::kernel::feed_forward) factors: &'a Factors,
    pub(in crate::kernel::feed_forward) decisions: Option<&'a UnitDecisions>,
    pub(in crate::kernel::feed_forward) first: usize,
    /// `[rows, width]`.
    pub(in crate::kernel::feed_forward) x: &'a [f32],
    pub(in crate::kernel::feed_forward) y: &'a mut [f32],
}

impl MatrixKernel for UnitForward<'_> {
    #[inline(always)]
    fn run<U: MatrixUnit>(self, unit: U) {
        let (simd, weights) = (unit.simd(), self.weights);
        let (width, columns) = (weights.width, weights.columns);
        let mut x_factors = vec![LeftFactor::ZERO; columns];
        let mut sums = vec![Block::ZERO_PANEL; columns];
        let (mut hidden, mut hidden_factor) = (Block::ZERO_PANEL, LeftFactor::ZERO);
        let groups = self.x.chunks(BLOCK * width).zip(self.y.chunks_mut(BLOCK * width));
        for (group, (x, y)) in groups.enumerate() {
            for (column, factor) in x_factors.iter_mut().enumerate() {
                load_rows(x, width, column, &mut hidden);
                left_factor(unit, &hidden, factor);
                sums[column] = [weights.b2[column]; BLOCK];
            }
            // The products of the block before are computed while the sums of this one are stored.
            for block in 0..=weights.units {
                if block < weights.units {
                    unit.start(Start::Row(weights.unit(block).b1()));
                    for (x, w1) in x_factors.iter().zip(&self.factors.w1_transposed[block * columns..]) {
                        unit.add_product(x, w1);
                    }
                    unit.store(&mut hidden);
                }
                if let Some(before) = block.checked_sub(1) {
                    for (sum, w2) in sums.iter_mut().zip(&self.factors.w2_transposed[before * columns..]) {
                        unit.start(Start::Panel(sum));
                        unit.add_product(&hidden_factor, w2);
                        unit.store(sum);
                    }
                }
                if block < weights.units {
                    if let Some(decisions) = self.decisions {
                        decisions.apply(simd, &mut hidden, self.first + group * BLOCK, block);
                    }
                    activate(unit, &hidden, &mut hidden_factor);
                }
            }
            for (column, sum) in sums.iter().enumerate() {
                for (y, sum) in y.chunks_exact_mut(width).zip(sum) {
                    let y = &mut y[column * BLOCK..];
                    match y.first_chunk_mut() {
                        Some(whole) => *whole = sum.0,
                        None => y.copy_from_slice(&sum.0[..y.len()]),
                    }
                }
            }
        }
    }
}

/// `ReLU`. It is the same before and after dropout.
#[inline(always)]
fn activate<U: MatrixUnit>(unit: U, sums: &Panel, factor: &mut LeftFactor) {
    let (simd, zero) = (unit.simd(), unit.simd().splat(0.0));
    for (row, sums) in sums.iter().enumerate() {
        let low = unit.pieces(simd.max(zero, simd.load(sums.part(0))));
        let high = unit.pieces(simd.max(zero, simd.load(sums.part(1))));
        factor.set_row(unit, row, [&low, &high]);
    }
}
