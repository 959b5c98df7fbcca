//! Sixteen heads, one after the other across rows, in blocks of four of their numbers as they lie in memory.
//!
//! Rows and heads make one index here, since every row has a memory of its own.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::KeyValue;
use crate::kernel::attention::exp2::exp2;
use crate::kernel::attention::lanes::{DEPTH, LANES, Lanes};

/// Sixteen heads' numbers of a block, head after head.
pub(super) type Natural = [Lanes; DEPTH];

/// Room for sixteen heads, kept from group to group.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffers {
    /// By block, scaled so that scores are powers of two.
    pub(super) query: Vec<Natural>,
    /// By block.
    pub(super) mixed_gradient: Vec<Natural>,
    /// By block.
    pub(super) query_gradient: Vec<Natural>,
    /// By token: scores, then powers.
    pub(super) powers: Vec<Lanes>,
    /// By token: the value's product with the gradient of what was mixed.
    pub(super) taken: Vec<Lanes>,
}

/// Where sixteen heads lie in a slice: `numbers` from `first` on, fewer than sixteen heads at its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) first: usize,
    pub(super) numbers: usize,
    pub(super) width: usize,
}

impl Place {
    /// Of the group that starts at `at` of `length` numbers, `first` being added to it in the whole slice.
    #[inline(always)]
    pub(super) fn new(first: usize, at: usize, length: usize, width: usize) -> Self {
        Self {
            first: first + at,
            numbers: (length - at).min(LANES * width),
            width,
        }
    }

    /// The numbers of a block; those that lack are 0. A slice that is too short is repeated.
    #[inline(always)]
    pub(super) fn load(self, from: &[f32], block: usize) -> Natural {
        let first = if self.first < from.len() {
            self.first
        } else {
            self.first % from.len()
        };
        let mut result = [Lanes::ZERO; DEPTH];
        if self.width == DEPTH
            && let Some(whole) = from[first..].first_chunk::<{ LANES * DEPTH }>()
            && self.numbers == LANES * DEPTH
        {
            for (lanes, numbers) in result.iter_mut().zip(whole.as_chunks().0) {
                lanes.0 = *numbers;
            }
        } else {
            self.each(block, |at, part, lane| {
                result[part].0[lane] = from[(self.first + at) % from.len()];
            });
        }
        result
    }

    /// Adds to the numbers of a block. The slice starts with the group.
    #[inline(always)]
    pub(super) fn add(self, sum: &Natural, into: &mut [f32], block: usize) {
        if self.width == DEPTH
            && self.numbers == LANES * DEPTH
            && let Some(whole) = into.first_chunk_mut::<{ LANES * DEPTH }>()
        {
            for (lanes, numbers) in sum.iter().zip(whole.as_chunks_mut().0) {
                *numbers = lanes.add(Lanes(*numbers)).0;
            }
        } else {
            self.each(block, |at, part, lane| into[at] += sum[part].0[lane]);
        }
    }

    /// Sets the numbers of a block. The slice starts with the group.
    #[inline(always)]
    pub(super) fn store(self, values: &Natural, into: &mut [f32], block: usize) {
        if self.width == DEPTH
            && self.numbers == LANES * DEPTH
            && let Some(whole) = into.first_chunk_mut::<{ LANES * DEPTH }>()
        {
            for (lanes, numbers) in values.iter().zip(whole.as_chunks_mut().0) {
                *numbers = lanes.0;
            }
        } else {
            self.each(block, |at, part, lane| into[at] = values[part].0[lane]);
        }
    }

    /// The place of a number after the first, and where it stands in a block.
    #[inline(always)]
    fn each(self, block: usize, mut f: impl FnMut(usize, usize, usize)) {
        let numbers = block * DEPTH..self.width.min((block + 1) * DEPTH);
        for head in 0..self.numbers / self.width {
            for number in numbers.clone() {
                let stands = head * DEPTH + number - block * DEPTH;
                f(head * self.width + number, stands / LANES, stands % LANES);
            }
        }
    }
}

/// Σ a b over the numbers of each head, added to `sums`.
#[inline(always)]
pub(super) fn dot(a: &Natural, b: &Natural, sums: Lanes) -> Lanes {
    let mut result = [0.0; LANES];
    for part in 0..DEPTH {
        let products = a[part].mul(b[part]).0;
        for head in 0..LANES / DEPTH {
            let at = head * DEPTH;
            result[part * (LANES / DEPTH) + head] =
                (products[at] + products[at + 1]) + (products[at + 2] + products[at + 3]);
        }
    }
    sums.add(Lanes(result))
}

/// `sum` + `weight` of each head · its numbers.
#[inline(always)]
pub(super) fn accumulate<const FUSED: bool>(sum: &mut Natural, weight: Lanes, numbers: &Natural) {
    for part in 0..DEPTH {
        sum[part] = spread(weight, part).mul_add::<FUSED>(numbers[part], sum[part]);
    }
}

/// `weight` of each head · its numbers.
#[inline(always)]
pub(super) fn weighted(weight: Lanes, numbers: &Natural) -> Natural {
    let mut result = [Lanes::ZERO; DEPTH];
    for part in 0..DEPTH {
        result[part] = spread(weight, part).mul(numbers[part]);
    }
    result
}

/// A number for each head, at each of the numbers of the heads in `part`.
#[inline(always)]
fn spread(weight: Lanes, part: usize) -> Lanes {
    let mut result = Lanes::ZERO;
    for head in 0..LANES / DEPTH {
        let value = weight.0[part * (LANES / DEPTH) + head];
        for number in 0..DEPTH {
            result.0[head * DEPTH + number] = value;
        }
    }
    result
}

/// Into `powers` 2^(score − largest score) for every token, the own one last; 1 over their sum.
#[inline(always)]
pub(super) fn soften<const FUSED: bool>(
    place: Place,
    query: &[Natural],
    memory: &[KeyValue<'_>],
    own: KeyValue<'_>,
    powers: &mut Vec<Lanes>,
) -> Lanes {
    powers.clear();
    let mut largest = Lanes::splat(f32::NEG_INFINITY);
    for token in memory.iter().chain([&own]) {
        let mut score = Lanes::ZERO;
        for (block, query) in query.iter().enumerate() {
            score = dot(query, &place.load(token.key, block), score);
        }
        largest = largest.max(score);
        powers.push(score);
    }
    let mut sum = Lanes::ZERO;
    for power in powers.iter_mut() {
        *power = exp2::<FUSED>(power.sub(largest));
        sum = sum.add(*power);
    }
    sum.reciprocal()
}
