//! The layout of sixteen heads in lanes, in sequence across rows, with the four numbers of each head.
//!
//! Rows and heads are one index here, because every row has a separate cache. Scores and weights, one for each head,
//! are in the order that transposing pieces of four lanes gives: head 4 k + i in lane 4 i + k.

use crate::kernel::buffer::add_to;
use crate::kernel::heads::HEAD_WIDTH;
use ddl_simd::{DEPTH, Floats, LANES, Lanes, Simd, Vectors};
use fearless_simd::prelude::*;

/// Keys and values of one token for each row, or their gradients: `[rows, heads, head width]` each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KeyValue<N> {
    pub(crate) key: N,
    pub(crate) value: N,
}

impl KeyValue<&mut [f32]> {
    pub(super) fn split_off(&mut self, count: usize) -> Self {
        Self {
            key: self.key.split_off_mut(..count).unwrap_or_default(),
            value: self.value.split_off_mut(..count).unwrap_or_default(),
        }
    }
}

/// How many groups of sixteen heads ahead tokens are prefetched. 6 and 10 were not faster.
const AHEAD: usize = 3;

/// Tokens are prefetched from this many numbers of cached keys on. With the values they take 1 MiB, half of a
/// second-level cache.
const PREFETCHED_FROM: usize = 1 << 17;

/// Whether these tokens are prefetched. The processor's newest prefetcher follows fewer streams than there are tokens.
pub(super) fn are_prefetched(cache: &[KeyValue<&[f32]>]) -> bool {
    cache.iter().map(|token| token.key.len()).sum::<usize>() >= PREFETCHED_FROM
}

/// The numbers of sixteen heads.
pub(super) const GROUP_NUMBERS: usize = LANES * HEAD_WIDTH;

/// The position of sixteen heads in a slice: `numbers` from `first` on. The last group may have fewer heads.
#[derive(Clone, Copy, Debug)]
pub(super) struct SixteenHeads {
    first: usize,
    numbers: usize,
}

impl SixteenHeads {
    /// The group at index `group` of a piece of `length` numbers that begins at `first` in the whole slice.
    #[inline(always)]
    pub(super) fn new(first: usize, group: usize, length: usize) -> Self {
        Self { first: first + group, numbers: (length - group).min(GROUP_NUMBERS) }
    }

    /// Loads the numbers; missing ones are 0. A slice that is too short is repeated.
    #[inline(always)]
    pub(super) fn load<S: Simd>(self, simd: S, from: &[f32]) -> Vectors<S> {
        let first = if self.first < from.len() { self.first } else { self.first % from.len() };
        if self.is_whole()
            && let Some(numbers) = from[first..].first_chunk()
        {
            return loaded(simd, numbers);
        }
        let mut numbers = [0.0; GROUP_NUMBERS];
        let contiguous = self.numbers.min(from.len() - first);
        numbers[..contiguous].copy_from_slice(&from[first..][..contiguous]);
        for index in contiguous..self.numbers {
            numbers[index] = from[(first + index) % from.len()];
        }
        loaded(simd, &numbers)
    }

    /// Prefetches the numbers of a later group.
    #[inline(always)]
    fn prefetch<S: Simd>(self, simd: S, from: &[f32]) {
        let ahead = from.get(self.first + AHEAD * GROUP_NUMBERS..);
        if let Some(group) = ahead.and_then(|from| from.first_chunk::<GROUP_NUMBERS>()) {
            for part in 0..DEPTH {
                simd.prefetch(&group[part * LANES]);
            }
        }
    }

    /// Adds to the numbers. The slice begins with the group.
    #[inline(always)]
    pub(super) fn add<S: Simd>(self, simd: S, terms: Vectors<S>, into: &mut [f32]) {
        if self.is_whole()
            && let Some(numbers) = into.first_chunk_mut()
        {
            let mut sums = loaded(simd, numbers);
            for part in 0..DEPTH {
                sums[part] += terms[part];
            }
            stored(simd, sums, numbers);
        } else {
            let mut numbers = [0.0; GROUP_NUMBERS];
            stored(simd, terms, &mut numbers);
            add_to(into, &numbers[..self.numbers]);
        }
    }

    /// Stores the numbers. The slice begins with the group.
    #[inline(always)]
    pub(super) fn store<S: Simd>(self, simd: S, values: Vectors<S>, into: &mut [f32]) {
        if self.is_whole()
            && let Some(numbers) = into.first_chunk_mut()
        {
            stored(simd, values, numbers);
        } else {
            let mut numbers = [0.0; GROUP_NUMBERS];
            stored(simd, values, &mut numbers);
            into[..self.numbers].copy_from_slice(&numbers[..self.numbers]);
        }
    }

    /// Whether there are sixteen heads.
    #[inline(always)]
    fn is_whole(self) -> bool {
        self.numbers == GROUP_NUMBERS
    }
}

#[inline(always)]
fn loaded<S: Simd>(simd: S, numbers: &[f32; GROUP_NUMBERS]) -> Vectors<S> {
    let parts = numbers.as_chunks().0;
    let mut vectors = [simd.splat(0.0); DEPTH];
    for part in 0..DEPTH {
        vectors[part] = simd.load(&parts[part]);
    }
    vectors
}

#[inline(always)]
fn stored<S: Simd>(simd: S, vectors: Vectors<S>, numbers: &mut [f32; GROUP_NUMBERS]) {
    let parts = numbers.as_chunks_mut().0;
    for part in 0..DEPTH {
        simd.store(vectors[part], &mut parts[part]);
    }
}

/// Σ a b over the numbers of each head.
#[inline(always)]
pub(super) fn dot<S: Simd>(simd: S, a: Vectors<S>, b: Vectors<S>) -> Floats<S> {
    let mut products = a;
    for part in 0..DEPTH {
        products[part] = a[part] * b[part];
    }
    let [a, b, c, d] = simd.transpose(products);
    a + b + (c + d)
}

/// `sum` + `weight` of each head · its numbers.
#[inline(always)]
pub(super) fn accumulate<S: Simd>(simd: S, sum: Vectors<S>, weight: Floats<S>, numbers: Vectors<S>) -> Vectors<S> {
    let (mut sum, weights) = (sum, simd.spread_each(weight));
    for part in 0..DEPTH {
        sum[part] = weights[part].mul_add(numbers[part], sum[part]);
    }
    sum
}

/// `weight` of each head · its numbers.
#[inline(always)]
pub(super) fn weighted<S: Simd>(simd: S, weight: Floats<S>, numbers: Vectors<S>) -> Vectors<S> {
    let (mut result, weights) = (numbers, simd.spread_each(weight));
    for part in 0..DEPTH {
        result[part] = weights[part] * numbers[part];
    }
    result
}

/// Sets `powers` to 2^(score − largest score) for all tokens, the newest token last. Returns 1 over their sum.
#[inline(always)]
pub(super) fn soften<S: Simd>(
    simd: S,
    place: SixteenHeads,
    query: Vectors<S>,
    cache: &[KeyValue<&[f32]>],
    newest: KeyValue<&[f32]>,
    powers: &mut [Lanes],
    prefetched: bool,
) -> Floats<S> {
    let mut largest = simd.splat(f32::NEG_INFINITY);
    for (token, power) in cache.iter().chain([&newest]).zip(&mut *powers) {
        if prefetched && place.is_whole() {
            place.prefetch(simd, token.key);
            place.prefetch(simd, token.value);
        }
        let score = dot(simd, query, place.load(simd, token.key));
        largest = largest.max(score);
        simd.store(score, &mut power.0);
    }
    let mut sum = simd.splat(0.0);
    for power in powers {
        let value = simd.exp2(simd.load(&power.0) - largest);
        sum += value;
        simd.store(value, &mut power.0);
    }
    simd.splat(1.0) / sum
}
