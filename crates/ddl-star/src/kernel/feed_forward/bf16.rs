//! The block with products of bf16 numbers, summed up in `f32`: twice as many multiplications an instruction.
//!
//! A product A B takes two numbers of a row of A and two rows of B at a time. So A is held with neighbours in a row paired,
//! B with neighbours in a column; what is needed both ways, as the derivatives want it, is held both ways.

#![expect(clippy::inline_always, reason = "kernels are compiled for the set")]

pub(super) mod backward;
pub(super) mod forward;
mod product;

use super::block::{BLOCK, Block, PARTS, Panel};
use super::block_rows::BlockRows;
use crate::kernel::instruction_set::PairDispatch;
use crate::kernel::lanes::LANES;
use crate::kernel::simd::{PairKernel, Pairs, Simd};

/// Pairs that [`BLOCK`] numbers make.
const PAIRS: usize = BLOCK / 2;

/// 32 numbers of a row, neighbours paired.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct PairedRow([u32; PAIRS]);

/// 32 numbers of each of two rows, those of a column paired.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct TwoRows([u32; BLOCK]);

/// 32 rows of 32 numbers, two by two.
pub(super) type PairPanel = [TwoRows; PAIRS];

impl PairedRow {
    const ZERO: Self = Self([0; PAIRS]);

    #[inline(always)]
    fn round<P: Pairs>(&mut self, pairs: P, row: &Block) {
        let simd = pairs.simd();
        let words = pairs.neighbours(simd.load(row.part(0)), simd.load(row.part(1)));
        pairs.store(words, &mut self.0);
    }
}

impl TwoRows {
    const ZERO: Self = Self([0; BLOCK]);

    /// The sixteen pairs from 16 `part` on.
    #[inline(always)]
    fn part(&self, part: usize) -> &[u32; LANES] {
        &self.0.as_chunks().0[part]
    }

    #[inline(always)]
    fn round<P: Pairs>(&mut self, pairs: P, rows: &[Block; 2]) {
        let simd = pairs.simd();
        for part in 0..PARTS {
            let [first, second] = [simd.load(rows[0].part(part)), simd.load(rows[1].part(part))];
            let words = pairs.across(first, second);
            pairs.store(words, &mut self.0.as_chunks_mut().0[part]);
        }
    }
}

/// Rounds squares of weights.
pub(super) fn round_panels(dispatch: PairDispatch, panels: &[Panel]) -> Vec<PairPanel> {
    let mut rounded = vec![[TwoRows::ZERO; PAIRS]; panels.len()];
    dispatch.run(RoundTwoByTwo {
        from: panels.as_flattened(),
        into: rounded.as_flattened_mut(),
    });
    rounded
}

/// Rows of x or gy, rounded.
pub(super) struct Rounded {
    /// As `BlockRows` has them.
    rows: Vec<PairedRow>,
    /// The same, two by two; empty where nobody needs it.
    two_by_two: Vec<TwoRows>,
    /// Rows.
    count: usize,
}

impl Rounded {
    pub(super) fn rows(dispatch: PairDispatch, from: &BlockRows, columns: usize) -> Self {
        let count = from.rows();
        let mut rows = vec![PairedRow::ZERO; columns * count];
        for column in 0..columns {
            dispatch.run(RoundRows {
                from: from.column(column),
                into: &mut rows[column * count..][..count],
            });
        }
        Self {
            rows,
            two_by_two: Vec::new(),
            count,
        }
    }

    /// By rows and two by two. The rows are even in number, as those of [`BlockRows::padded`] are.
    pub(super) fn both_ways(dispatch: PairDispatch, from: &BlockRows, columns: usize) -> Self {
        let half = from.rows() / 2;
        let mut two_by_two = vec![TwoRows::ZERO; columns * half];
        for column in 0..columns {
            dispatch.run(RoundTwoByTwo {
                from: from.column(column),
                into: &mut two_by_two[column * half..][..half],
            });
        }
        Self {
            two_by_two,
            ..Self::rows(dispatch, from, columns)
        }
    }

    /// R rows of a column of blocks, from `row`.
    #[inline]
    fn tile<const R: usize>(&self, column: usize, row: usize) -> &[PairedRow; R] {
        let rows = &self.rows[column * self.count..][..self.count];
        rows[row..].first_chunk().expect("rows in whole tiles")
    }

    /// `count` rows of a column of blocks, from `row`, two by two.
    #[inline]
    fn two_by_two(&self, column: usize, row: usize, count: usize) -> &[TwoRows] {
        let half = self.count / 2;
        &self.two_by_two[column * half..][..half][row / 2..][..count / 2]
    }
}

struct RoundRows<'a> {
    from: &'a [Block],
    into: &'a mut [PairedRow],
}

impl PairKernel for RoundRows<'_> {
    #[inline(always)]
    fn run<P: Pairs>(self, pairs: P) {
        for (row, into) in self.from.iter().zip(self.into) {
            into.round(pairs, row);
        }
    }
}

struct RoundTwoByTwo<'a> {
    from: &'a [Block],
    into: &'a mut [TwoRows],
}

impl PairKernel for RoundTwoByTwo<'_> {
    #[inline(always)]
    fn run<P: Pairs>(self, pairs: P) {
        for (rows, into) in self.from.as_chunks().0.iter().zip(self.into) {
            into.round(pairs, rows);
        }
    }
}
