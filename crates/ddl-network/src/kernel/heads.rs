//! The layout of heads in lanes: eight heads of each of two pedestrians, and the four numbers of each head.

use crate::kernel::quads::{HALF, HalfQuad, Quads as _};
use ddl_simd::{DEPTH, Dispatch, Simd, Vectors};

/// Numbers of a head.
pub(crate) const HEAD_WIDTH: usize = DEPTH;
/// Heads in a half of the lanes.
pub(super) const GROUP: usize = HALF;
/// 1 / √[`HEAD_WIDTH`], so that the variance of scores does not depend on the width.
pub(super) const SCALE: f32 = 0.5;

/// The numbers of a group of heads in one row, a half of a vector at a time.
type Halves = [[f32; HALF]; DEPTH];
const ZERO_HALVES: Halves = HalfQuad::ZERO.0;

/// Multi-head attention. Weights below 2^−96 of the largest count as 0. Results do not depend on the number of threads;
/// those of different instruction sets agree up to rounding.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AttentionKernel {
    pub(super) heads: Heads,
    pub(super) dispatch: Dispatch,
}

impl AttentionKernel {
    pub(crate) fn new(heads: usize) -> Self {
        Self { heads: Heads::new(heads), dispatch: Dispatch::detect() }
    }
}

/// The number of heads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Heads(usize);

impl Heads {
    pub(super) fn new(count: usize) -> Self {
        assert!((1..=256).contains(&count), "{count} heads: 1 to 256 are needed");
        Self(count)
    }

    pub(super) fn row(self) -> usize {
        self.0 * HEAD_WIDTH
    }

    pub(super) fn groups(self) -> usize {
        self.0.div_ceil(GROUP)
    }
}

/// Loads a group of heads of two rows; heads beyond the last and a missing row count as zeros. Vector d holds the d-th
/// number of each head.
///
/// Lane l holds head `head_of(l)` of the group, from row `row_of(l)`. In this order, transposing pieces of four lanes
/// is enough.
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, group: usize, first: &[f32], second: Option<&[f32]>) -> Vectors<S> {
    if let Some(a) = whole_halves(group, first)
        && let Some(b) = second.map_or(Some(&ZERO_HALVES), |row| whole_halves(group, row))
    {
        return loaded(simd, a, b);
    }
    let b = second.map_or(ZERO_HALVES, |row| gathered(group, row));
    loaded(simd, &gathered(group, first), &b)
}

#[inline(always)]
pub(super) fn store<S: Simd>(
    simd: S,
    vectors: Vectors<S>,
    group: usize,
    first: &mut [f32],
    second: Option<&mut [f32]>,
) {
    let [mut a, mut b] = [HalfQuad::ZERO; 2];
    simd.write_halves(simd.transpose(vectors), &mut a, &mut b);
    store_row(&a.0, group, first);
    if let Some(second) = second {
        store_row(&b.0, group, second);
    }
}

/// Stores the sums of the numbers of both rows.
#[inline(always)]
pub(super) fn store_sum<S: Simd>(simd: S, vectors: Vectors<S>, group: usize, row: &mut [f32]) {
    let [mut a, mut b] = [HalfQuad::ZERO; 2];
    simd.write_halves(simd.transpose(vectors), &mut a, &mut b);
    for (a, b) in a.0.as_flattened_mut().iter_mut().zip(b.0.as_flattened()) {
        *a += b;
    }
    store_row(&a.0, group, row);
}

#[inline(always)]
fn store_row(numbers: &Halves, group: usize, row: &mut [f32]) {
    let rest = &mut row[group * GROUP * HEAD_WIDTH..];
    if let Some(whole) = rest.as_chunks_mut().0.first_chunk_mut() {
        *whole = *numbers;
    } else {
        rest.copy_from_slice(&numbers.as_flattened()[..rest.len()]);
    }
}

/// The numbers of a group that is smaller than the others.
#[inline(always)]
fn gathered(group: usize, row: &[f32]) -> Halves {
    let mut numbers = ZERO_HALVES;
    let rest = &row[group * GROUP * HEAD_WIDTH..];
    numbers.as_flattened_mut()[..rest.len()].copy_from_slice(rest);
    numbers
}

#[inline(always)]
fn whole_halves(group: usize, row: &[f32]) -> Option<&Halves> {
    row.as_chunks().0.get(group * DEPTH..)?.first_chunk()
}

#[inline(always)]
fn loaded<S: Simd>(simd: S, low: &Halves, high: &Halves) -> Vectors<S> {
    let mut numbers = [simd.splat(0.0); DEPTH];
    for d in 0..DEPTH {
        numbers[d] = simd.load_halves(&low[d], &high[d]);
    }
    simd.transpose(numbers)
}

/// Which of two rows a lane holds.
pub(super) const fn row_of(lane: usize) -> usize {
    lane / GROUP
}

/// Which head of a group a lane holds.
pub(super) const fn head_of(lane: usize) -> usize {
    2 * (lane % DEPTH) + lane % GROUP / DEPTH
}
