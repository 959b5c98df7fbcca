//! Four rows at a time. Their sums share the instructions that add across lanes.

use crate::kernel::dropout::{Dropout, RowKey, Threshold, mixed};
use ddl_simd::{DEPTH, Floats, Lanes, Simd, Vectors};
use fearless_simd::prelude::*;

/// Four rows, by vectors of columns.
pub(super) struct Four(Vec<[Lanes; DEPTH]>);

impl Four {
    #[inline(always)]
    pub(super) fn new(vectors: usize) -> Self {
        Self(vec![[Lanes::ZERO; DEPTH]; vectors])
    }

    #[inline(always)]
    pub(super) fn vectors(&self) -> usize {
        self.0.len()
    }

    #[inline(always)]
    pub(super) fn get<S: Simd>(&self, simd: S, row: usize, vector: usize) -> Floats<S> {
        simd.load(&self.0[vector][row].0)
    }

    #[inline(always)]
    pub(super) fn set<S: Simd>(&mut self, simd: S, row: usize, vector: usize, value: Floats<S>) {
        simd.store(value, &mut self.0[vector][row].0);
    }

    /// Partial sums over each row, one for each lane.
    #[inline(always)]
    pub(super) fn sums<S: Simd>(&self, simd: S) -> Vectors<S> {
        let mut sums = [simd.splat(0.0); DEPTH];
        for r in 0..DEPTH {
            for v in 0..self.vectors() {
                sums[r] += self.get(simd, r, v);
            }
        }
        sums
    }

    #[inline(always)]
    pub(super) fn products<S: Simd>(&self, simd: S, other: &Self) -> Vectors<S> {
        let mut sums = [simd.splat(0.0); DEPTH];
        for r in 0..DEPTH {
            for v in 0..self.vectors() {
                let (a, b) = (self.get(simd, r, v), other.get(simd, r, v));
                sums[r] = a.mul_add(b, sums[r]);
            }
        }
        sums
    }
}

/// Means over `width` numbers, from four vectors of partial sums. Lanes 4 i + k hold the mean of row k.
#[inline(always)]
pub(super) fn means<S: Simd>(simd: S, width: usize, sums: Vectors<S>) -> Floats<S> {
    // Lane 4 i + k holds a part of the sum of row k.
    let [a, b, c, d] = simd.transpose(sums);
    simd.sum_of_quarters(a + b + (c + d)) * (1.0 / width as f32)
}

/// Decides which numbers of t are dropped: a function of only (seed, row, column), with 24 random bits.
#[derive(Clone, Copy, Debug)]
pub(in crate::kernel) struct Decisions {
    seed: u64,
    least: u32,
    scale: f32,
}

impl Decisions {
    /// `None` if nothing is dropped.
    pub(in crate::kernel) fn new(dropout: Dropout) -> Option<Self> {
        let Threshold { least, scale } = dropout.threshold(24)?;
        Some(Self { seed: mixed(dropout.seed), least: least << 8, scale })
    }

    #[inline(always)]
    pub(super) fn apply<S: Simd>(self, simd: S, numbers: Floats<S>, row: usize, column: usize) -> Floats<S> {
        let bits = RowKey::new(self.seed, row as u64).bits(simd, column);
        simd.keep(numbers, bits, self.least) * self.scale
    }
}
