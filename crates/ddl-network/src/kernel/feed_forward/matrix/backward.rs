//! The backward pass on a matrix unit.

use super::{Factors, RowPieces, left_factor, load_rows, set_rows};
use crate::kernel::feed_forward::backward::{Scratch, UnitGradients};
use crate::kernel::feed_forward::block::{BLOCK, Block, Panel, tile_mut};
use crate::kernel::feed_forward::dropout::UnitDecisions;
use crate::kernel::feed_forward::weights::BlockWeights;
use ddl_simd::{LeftFactor, MatrixKernel, MatrixUnit, RightFactor, Simd, Start, transpose};

/// Number of groups of 32 rows whose factors are kept for the gradients of the weights.
const KEPT: usize = 2;
const BLOCKS: usize = 2;

/// The factors of 32 rows of x and of gy, for one block of columns.
#[derive(Clone, Debug)]
pub(in crate::kernel::feed_forward) struct RowFactors {
    x: LeftFactor,
    x_transposed: LeftFactor,
    gy: LeftFactor,
    gy_transposed: LeftFactor,
}

impl RowFactors {
    pub(in crate::kernel::feed_forward) const ZERO: Self = Self {
        x: LeftFactor::ZERO,
        x_transposed: LeftFactor::ZERO,
        gy: LeftFactor::ZERO,
        gy_transposed: LeftFactor::ZERO,
    };
}

/// Sets the factors of all columns of at most 32 rows.
pub(in crate::kernel::feed_forward) struct SetRowFactors<'a> {
    pub(in crate::kernel::feed_forward) width: usize,
    pub(in crate::kernel::feed_forward) x: &'a [f32],
    pub(in crate::kernel::feed_forward) gy: &'a [f32],
    pub(in crate::kernel::feed_forward) factors: &'a mut [RowFactors],
}

impl MatrixKernel for SetRowFactors<'_> {
    #[inline(always)]
    fn run<U: MatrixUnit>(self, unit: U) {
        let [mut panel, mut transposed] = [Block::ZERO_PANEL; 2];
        for (column, factors) in self.factors.iter_mut().enumerate() {
            for (rows, factor, of_transposed) in [
                (self.x, &mut factors.x, &mut factors.x_transposed),
                (self.gy, &mut factors.gy, &mut factors.gy_transposed),
            ] {
                load_rows(rows, self.width, column, &mut panel);
                transpose(&panel, &mut transposed);
                left_factor(unit, &panel, factor);
                left_factor(unit, &transposed, of_transposed);
            }
        }
    }
}

pub(in crate::kernel::feed_forward) struct UnitBackward<'a, 'b> {
    pub(in crate::kernel::feed_forward) weights: &'a BlockWeights,
    pub(in crate::kernel::feed_forward) factors: &'a Factors,
    pub(in crate::kernel::feed_forward) decisions: Option<&'a UnitDecisions>,
    pub(in crate::kernel::feed_forward) first: usize,
    pub(in crate::kernel::feed_forward) units: usize,
    /// All columns of the first 32 rows, then those of the next rows, and so on.
    pub(in crate::kernel::feed_forward) rows: &'a [RowFactors],
    pub(in crate::kernel::feed_forward) scratch: &'a mut Scratch,
    pub(in crate::kernel::feed_forward) part: &'a mut UnitGradients<'b>,
}

impl MatrixKernel for UnitBackward<'_, '_> {
    #[inline(always)]
    fn run<U: MatrixUnit>(self, unit: U) {
        let Self {
            weights,
            factors,
            decisions,
            first,
            units,
            rows,
            scratch: Scratch { gx, w1, w2, .. },
            part,
        } = self;
        let simd = unit.simd();
        let columns = weights.columns;
        let scale = decisions.map_or(1.0, |decisions| decisions.scale);
        let [mut hidden, mut gradient] = [Block::ZERO_PANEL; 2];
        let mut of_block = vec![BlockFactors::ZERO; BLOCKS * KEPT];
        for column in 0..columns {
            gx.column_mut(column).fill(Block::ZERO);
        }
        let blocks = part.blocks();
        let mut b1 = vec![[simd.splat(0.0); 2]; blocks];
        w1.resize(blocks * columns, Block::ZERO_PANEL);
        w2.resize(blocks * columns, Block::ZERO_PANEL);
        w1.fill(Block::ZERO_PANEL);
        w2.fill(Block::ZERO_PANEL);
        for (piece, rows) in rows.chunks(KEPT * columns).enumerate() {
            let groups = rows.len() / columns;
            for block in (0..blocks).step_by(BLOCKS) {
                let these = block..blocks.min(block + BLOCKS);
                for (u, of_block) in these.clone().zip(of_block.chunks_mut(KEPT)) {
                    let at = (units + u) * columns;
                    for (group, (rows, of_block)) in rows.chunks_exact(columns).zip(of_block).enumerate() {
                        unit.start(Start::Row(weights.unit(units + u).b1()));
                        for (rows, w1) in rows.iter().zip(&factors.w1_transposed[at..]) {
                            unit.add_product(&rows.x, w1);
                        }
                        unit.store(&mut hidden);
                        unit.start(Start::Row(&Block::ZERO));
                        for (rows, w2) in rows.iter().zip(&factors.w2[at..]) {
                            unit.add_product(&rows.gy, w2);
                        }
                        unit.store(&mut gradient);
                        if let Some(decisions) = decisions {
                            let row = first + (piece * KEPT + group) * BLOCK;
                            decisions.apply(simd, &mut hidden, row, units + u);
                        }
                        b1[u] = of_block.set(unit, &hidden, &gradient, scale, b1[u]);
                    }
                }
                for c in 0..columns {
                    for group in 0..groups {
                        let gx = tile_mut(gx.column_mut(c), (piece * KEPT + group) * BLOCK);
                        unit.start(Start::Panel(gx));
                        for (u, of_block) in these.clone().zip(of_block.chunks(KEPT)) {
                            unit.add_product(&of_block[group].gradient, &factors.w1[(units + u) * columns + c]);
                        }
                        unit.store(gx);
                    }
                    for (u, of_block) in these.clone().zip(of_block.chunks(KEPT)) {
                        let [w1, w2] = [&mut w1[u * columns + c], &mut w2[u * columns + c]];
                        let groups = || rows.iter().skip(c).step_by(columns).zip(of_block);
                        unit.start(Start::Panel(w1));
                        for (rows, of_block) in groups() {
                            unit.add_product(&rows.x_transposed, &of_block.gradient_pairs);
                        }
                        unit.store(w1);
                        unit.start(Start::Panel(w2));
                        for (rows, of_block) in groups() {
                            unit.add_product(&rows.gy_transposed, &of_block.hidden_pairs);
                        }
                        unit.store(w2);
                    }
                }
            }
        }
        let mut of_w1 = Block::ZERO_PANEL;
        for u in 0..blocks {
            let mut sums = Block::ZERO;
            for half in 0..2 {
                simd.store(b1[u][half], sums.part_mut(half));
            }
            part.add_to_b1(u, &sums);
            for column in 0..columns {
                transpose(&w1[u * columns + column], &mut of_w1);
                part.add(weights.width, u, column, &of_w1, &w2[u * columns + column]);
            }
        }
    }
}

/// The hidden activations of 32 rows and 32 units and their gradients.
#[derive(Clone)]
struct BlockFactors {
    hidden_pairs: RightFactor,
    gradient: LeftFactor,
    gradient_pairs: RightFactor,
}

impl BlockFactors {
    const ZERO: Self = Self {
        hidden_pairs: RightFactor::ZERO,
        gradient: LeftFactor::ZERO,
        gradient_pairs: RightFactor::ZERO,
    };

    /// `hidden` before `ReLU`, and `gradient` after it and before scaling. Returns `sums` plus the sums of the gradients
    /// over the rows.
    #[inline(always)]
    fn set<U: MatrixUnit>(
        &mut self,
        unit: U,
        hidden: &Panel,
        gradient: &Panel,
        scale: f32,
        sums: [<U::Simd as Simd>::Floats; 2],
    ) -> [<U::Simd as Simd>::Floats; 2] {
        let (simd, mut sums) = (unit.simd(), sums);
        let [zero, scale] = [simd.splat(0.0), simd.splat(scale)];
        let nothing = unit.pieces(zero);
        for pair in 0..BLOCK / 2 {
            let mut of_hidden: [RowPieces<U>; 2] = [[nothing; 2]; 2];
            let mut of_gradient: [RowPieces<U>; 2] = [[nothing; 2]; 2];
            for r in 0..2 {
                let row = 2 * pair + r;
                for part in 0..2 {
                    let active = simd.max(zero, simd.load(hidden[row].part(part)));
                    let back = simd.mul(simd.load(gradient[row].part(part)), scale);
                    let back = simd.zero_unless_positive(active, back);
                    sums[part] = simd.add(sums[part], back);
                    of_hidden[r][part] = unit.pieces(active);
                    of_gradient[r][part] = unit.pieces(back);
                }
                let [low, high] = &of_gradient[r];
                self.gradient.set_row(unit, row, [low, high]);
            }
            set_rows(unit, &mut self.hidden_pairs, pair, of_hidden);
            set_rows(unit, &mut self.gradient_pairs, pair, of_gradient);
        }
        sums
    }
}
