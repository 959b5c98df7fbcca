//! The sieve of a search: `f32` scores that exclude nearly every candidate, and never one of the nearest.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::blocks::{BlockRun, BlockStep, Blocks, FREE};
use crate::range::Range;
use crate::recursion::{GROUP, load, recursion};
use crate::select::Selection;
use ddl_simd::{Dispatch, InstructionSet, Kernel, LANES, Lanes, Simd};
use fearless_simd::prelude::*;

/// The candidates in blocks, with the weights that normalise their scores.
#[derive(Clone, Debug)]
pub(crate) struct CandidateSieve<const D: usize> {
    blocks: Blocks<D>,
    /// 2^(D(y, y) / 2) with D in log2 units, for each lane of each block; 0 in free lanes.
    weights: Vec<Lanes>,
}

struct Search<const D: usize> {
    steps: Vec<[f32; D]>,
    range: Range,
    largest: f64,
    start: f32,
    selection: Selection,
}

impl<const D: usize> CandidateSieve<D> {
    /// The sieve of candidates of known D(y, y), or `None` if `f32` cannot hold them for any query.
    pub(crate) fn build(gamma: f64, candidates: &[&[[f64; D]]], self_values: &[f64]) -> Option<Self> {
        let blocks = Blocks::new(gamma, candidates);
        let range = Range::new(InstructionSet::Portable, 1, blocks.longest)?;
        range.margin_log2(f64::from(range.start_log2), blocks.largest, D)?;
        let half_to_log2 = blocks.narrowing.scale * blocks.narrowing.scale / 2.0;
        let weight = |&member: &usize| match self_values.get(member) {
            Some(value) => (value * half_to_log2).exp2() as f32,
            None => 0.0,
        };
        let weights = blocks.members.iter().map(|members| {
            let mut lanes = Lanes::ZERO;
            lanes.0.iter_mut().zip(members).for_each(|(lane, member)| *lane = weight(member));
            lanes
        });
        Some(Self { weights: weights.collect(), blocks })
    }

    /// The candidates that may be among the `wanted` nearest of a query, or `None` if `f32` is not accurate enough.
    pub(crate) fn survivors(&self, dispatch: Dispatch, query: &[[f64; D]], wanted: usize) -> Option<Vec<usize>> {
        let mut search = self.search(dispatch.instruction_set(), query, wanted)?;
        for run in &self.blocks.runs {
            self.sweep(dispatch, run, &mut search);
        }
        let (range, largest) = (search.range, search.largest);
        let margin = |nth_log2| range.margin_log2(nth_log2, largest, D);
        search.selection.survivors(range.smallest_accurate_log2(), margin)
    }

    /// The state of a query before its first block, or `None` if its scores would not be accurate.
    fn search(&self, set: InstructionSet, query: &[[f64; D]], wanted: usize) -> Option<Search<D>> {
        let range = Range::new(set, query.len(), self.blocks.longest)?;
        let narrowing = &self.blocks.narrowing;
        let largest = self.blocks.largest.max(narrowing.largest(query.iter()));
        let widest = range.margin_log2(range.smallest_accurate_log2(), largest, D)?;
        Some(Search {
            steps: narrowing.narrow(query),
            range,
            largest,
            start: f32::from(range.start_log2).exp2(),
            selection: Selection::new(wanted, widest),
        })
    }

    fn sweep(&self, dispatch: Dispatch, run: &BlockRun, search: &mut Search<D>) {
        dispatch.run(CandidateSweep {
            query: &search.steps,
            steps: run.steps,
            samples: self.blocks.samples(run),
            weights: &self.weights[run.blocks.clone()],
            members: &self.blocks.members[run.blocks.clone()],
            start: search.start,
            selection: &mut search.selection,
        });
    }
}

/// Scores of consecutive blocks, 2^(`start_log2` − D(x, y) + D(y, y) / 2) with D in log2 units, offered to a selection.
struct CandidateSweep<'a, const D: usize> {
    query: &'a [[f32; D]],
    steps: usize,
    samples: &'a [BlockStep<D>],
    weights: &'a [Lanes],
    members: &'a [[usize; LANES]],
    start: f32,
    selection: &'a mut Selection,
}

impl<const D: usize> Kernel for CandidateSweep<'_, D> {
    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        // The row stays in registers if the compiler knows its length, so the lengths of pedestrians are compiled
        // separately.
        match self.steps {
            // This many similarities, a row and the coefficients do not fit the few registers of the smallest
            // instruction sets.
            7 if <S::f32s as SimdBase<S>>::LEN < 8 => self.fixed::<S, 7, GROUP>(simd),
            8 if <S::f32s as SimdBase<S>>::LEN < 8 => self.fixed::<S, 8, GROUP>(simd),
            7 => self.fixed::<S, 7, 7>(simd),
            8 => self.fixed::<S, 8, 8>(simd),
            steps => {
                let mut row = vec![S::f32s::splat(simd, 0.0); steps];
                for (b, block) in self.samples.chunks_exact(steps).enumerate() {
                    self.block::<S, GROUP>(simd, b, block, &mut row);
                }
            }
        }
    }
}

impl<const D: usize> CandidateSweep<'_, D> {
    #[inline(always)]
    fn fixed<S: Simd, const M: usize, const G: usize>(&mut self, simd: S) {
        let (blocks, _) = self.samples.as_chunks::<M>();
        for (b, block) in blocks.iter().enumerate() {
            self.block::<S, G>(simd, b, block, &mut [S::f32s::splat(simd, 0.0); M]);
        }
    }

    /// Computes the scores of block `b`, and offers those that reach the threshold.
    #[inline(always)]
    fn block<S: Simd, const G: usize>(&mut self, simd: S, b: usize, block: &[BlockStep<D>], row: &mut [S::f32s]) {
        let width = <S::f32s as SimdBase<S>>::LEN;
        let mut scores = [0.0; LANES];
        let threshold = self.selection.threshold;
        let mut mask = 0;
        for part in 0..LANES / width {
            let start = load(simd, &self.weights[b], part) * self.start;
            let score = recursion::<S, D, G>(simd, self.query, block, part, start, row);
            mask |= (score.simd_ge(threshold).to_bitmask() as u32) << (part * width);
            score.store_slice(&mut scores[part * width..][..width]);
        }
        if mask != 0 {
            offer(self.selection, &scores, &self.members[b], mask);
        }
    }
}

#[cold]
#[inline(never)]
fn offer(selection: &mut Selection, scores: &[f32; LANES], members: &[usize; LANES], mut mask: u32) {
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        if members[lane] != FREE {
            selection.offer(scores[lane], members[lane]);
        }
    }
}

#[cfg(test)]
mod tests;
