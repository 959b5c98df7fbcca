//! The forward pass with products of bf16 numbers, summed up in `f32`: twice as many multiplications an instruction.
//!
//! A product A B takes two numbers of a row of A and two rows of B at a time. So A is held with neighbours in a row paired,
//! B with neighbours in a column.

#![expect(clippy::inline_always, reason = "kernels are compiled for the set")]

pub(super) mod forward;
mod product;

use super::block::{BLOCK, Block, PARTS, Panel};
use super::weights::Weights;
use ddl_simd::{LANES, PairDispatch, PairKernel, Pairs, Simd};

/// Pairs that [`BLOCK`] numbers make.
const PAIRS: usize = BLOCK / 2;

/// 32 numbers of a row, neighbours paired.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct PairedRow([u32; PAIRS]);

/// 32 numbers of each of two rows, those of a column paired.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct TwoRows([u32; BLOCK]);

/// 32 rows of 32 numbers, two by two.
type PairPanel = [TwoRows; PAIRS];

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

/// The squares of [`Weights`] that the forward pass reads, rounded.
#[derive(Clone, Debug)]
pub(super) struct Squares {
    w1_transposed: Vec<PairPanel>,
    w2_transposed: Vec<PairPanel>,
}

impl Squares {
    pub(super) fn round(weights: &Weights, dispatch: PairDispatch) -> Self {
        let round = |panels: &[Panel]| {
            let mut rounded = vec![[TwoRows::ZERO; PAIRS]; panels.len()];
            dispatch.run(Round {
                from: panels.as_flattened(),
                into: rounded.as_flattened_mut(),
            });
            rounded
        };
        Self {
            w1_transposed: round(&weights.w1_transposed),
            w2_transposed: round(&weights.w2_transposed),
        }
    }
}

/// Rows, two by two.
struct Round<'a> {
    from: &'a [Block],
    into: &'a mut [TwoRows],
}

impl PairKernel for Round<'_> {
    #[inline(always)]
    fn run<P: Pairs>(self, pairs: P) {
        for (rows, into) in self.from.as_chunks().0.iter().zip(self.into) {
            into.round(pairs, rows);
        }
    }
}
