//! The layout of sixteen heads in lanes, in sequence across rows, four of their numbers (a quad) at a time.
//!
//! Rows and heads are one index here, because every row has a separate cache. Scores and weights, one for each head,
//! are in the order that transposing pieces of four lanes gives: head 4 k + i in lane 4 i + k.

use crate::kernel::threads::JobBuffers;
use ddl_simd::{DEPTH, Floats, LANES, Lanes, Quad, Simd, Vectors, ZERO_QUAD};
use std::cell::Cell;
use std::thread::LocalKey;

/// Keys and values of one token for each row, `[rows, heads, head width]` each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KeyValue<'a> {
    pub(crate) key: &'a [f32],
    pub(crate) value: &'a [f32],
}

/// Gradients of a [`KeyValue`], of the same shapes.
pub(crate) struct KeyValueMut<'a> {
    pub(crate) key: &'a mut [f32],
    pub(crate) value: &'a mut [f32],
}

impl KeyValueMut<'_> {
    pub(super) fn reborrow(&mut self) -> KeyValueMut<'_> {
        KeyValueMut {
            key: self.key,
            value: self.value,
        }
    }
}

impl<'a> KeyValueMut<'a> {
    pub(super) fn split_off(&mut self, count: usize) -> KeyValueMut<'a> {
        KeyValueMut {
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
pub(super) fn are_prefetched(cache: &[KeyValue<'_>]) -> bool {
    cache.iter().map(|token| token.key.len()).sum::<usize>() >= PREFETCHED_FROM
}

/// Buffers for sixteen heads, reused by the next group.
#[derive(Clone, Debug, Default)]
pub(super) struct TemporalBuffers {
    /// The query, one entry for each quad; scaled so that scores are exponents of two.
    pub(super) query: Vec<Quad>,
    /// For each quad.
    pub(super) mixed_gradient: Vec<Quad>,
    /// For each quad.
    pub(super) query_gradient: Vec<Quad>,
    /// For each token: scores, then powers.
    pub(super) powers: Vec<Lanes>,
    /// For each token: the product of its value and the gradient of the mixed values.
    pub(super) taken: Vec<Lanes>,
}

impl JobBuffers for TemporalBuffers {
    fn of_thread() -> &'static LocalKey<Cell<Self>> {
        thread_local!(static BUFFERS: Cell<TemporalBuffers> = Cell::default());
        &BUFFERS
    }
}

/// The position of sixteen heads in a slice: `numbers` from `first` on. The last group may have fewer heads.
#[derive(Clone, Copy, Debug)]
pub(super) struct SixteenHeads {
    pub(super) first: usize,
    pub(super) numbers: usize,
    pub(super) width: usize,
}

impl SixteenHeads {
    /// The group at index `group` of a piece of `length` numbers that begins at `first` in the whole slice.
    #[inline(always)]
    pub(super) fn new(first: usize, group: usize, length: usize, width: usize) -> Self {
        Self {
            first: first + group,
            numbers: (length - group).min(LANES * width),
            width,
        }
    }

    /// Loads the numbers of a quad; missing numbers are 0. A slice that is too short is repeated.
    #[inline(always)]
    pub(super) fn load<S: Simd>(self, simd: S, from: &[f32], quad: usize) -> Vectors<S> {
        let first = if self.first < from.len() {
            self.first
        } else {
            self.first % from.len()
        };
        if self.whole()
            && let Some(numbers) = from[first..].first_chunk::<{ LANES * DEPTH }>()
        {
            let parts = numbers.as_chunks().0;
            let mut result = [simd.splat(0.0); DEPTH];
            for part in 0..DEPTH {
                result[part] = simd.load(&parts[part]);
            }
            return result;
        }
        let mut gathered = ZERO_QUAD;
        if self.width == DEPTH && self.numbers <= from.len() - first {
            // A group of fewer heads, contiguous in the slice.
            let numbers = from[first..][..self.numbers].chunks(LANES);
            for (part, numbers) in gathered.iter_mut().zip(numbers) {
                part.0[..numbers.len()].copy_from_slice(numbers);
            }
        } else {
            self.for_each(quad, |index, part, lane| {
                gathered[part].0[lane] = from[(self.first + index) % from.len()];
            });
        }
        simd.read(&gathered)
    }

    /// Prefetches the numbers of a later group.
    #[inline(always)]
    fn prefetch<S: Simd>(self, simd: S, from: &[f32]) {
        let ahead = from.get(self.first + AHEAD * LANES * DEPTH..);
        if let Some(group) = ahead.and_then(|from| from.first_chunk::<{ LANES * DEPTH }>()) {
            for part in 0..DEPTH {
                simd.prefetch(&group[part * LANES]);
            }
        }
    }

    /// Adds to the numbers of a quad. The slice begins with the group.
    #[inline(always)]
    pub(super) fn add<S: Simd>(self, simd: S, sum: Vectors<S>, into: &mut [f32], quad: usize) {
        if self.whole()
            && let Some(numbers) = into.first_chunk_mut::<{ LANES * DEPTH }>()
        {
            let numbers = numbers.as_chunks_mut().0;
            for part in 0..DEPTH {
                let before = simd.load(&numbers[part]);
                simd.store(simd.add(before, sum[part]), &mut numbers[part]);
            }
        } else {
            let mut numbers = ZERO_QUAD;
            simd.write(sum, &mut numbers);
            self.for_each(quad, |index, part, lane| into[index] += numbers[part].0[lane]);
        }
    }

    /// Stores the numbers of a quad. The slice begins with the group.
    #[inline(always)]
    pub(super) fn store<S: Simd>(self, simd: S, values: Vectors<S>, into: &mut [f32], quad: usize) {
        if self.whole()
            && let Some(numbers) = into.first_chunk_mut::<{ LANES * DEPTH }>()
        {
            let numbers = numbers.as_chunks_mut().0;
            for part in 0..DEPTH {
                simd.store(values[part], &mut numbers[part]);
            }
        } else {
            let mut numbers = ZERO_QUAD;
            simd.write(values, &mut numbers);
            self.for_each(quad, |index, part, lane| into[index] = numbers[part].0[lane]);
        }
    }

    /// Whether the numbers of the sixteen heads have the layout of a single quad.
    #[inline(always)]
    fn whole(self) -> bool {
        self.width == DEPTH && self.numbers == LANES * DEPTH
    }

    /// Calls `f` with the index of each number after the first, and its position in a quad.
    #[inline(always)]
    fn for_each(self, quad: usize, mut f: impl FnMut(usize, usize, usize)) {
        let numbers = quad * DEPTH..self.width.min((quad + 1) * DEPTH);
        for head in 0..self.numbers / self.width {
            for number in numbers.clone() {
                let stands = head * DEPTH + number - quad * DEPTH;
                f(head * self.width + number, stands / LANES, stands % LANES);
            }
        }
    }
}

/// Σ a b over the numbers of each head, added to `start`.
#[inline(always)]
pub(super) fn dot<S: Simd>(simd: S, a: Vectors<S>, b: Vectors<S>, start: Floats<S>) -> Floats<S> {
    let mut products = a;
    for part in 0..DEPTH {
        products[part] = simd.mul(a[part], b[part]);
    }
    let [a, b, c, d] = simd.transpose(products);
    simd.add(start, simd.add(simd.add(a, b), simd.add(c, d)))
}

/// `sum` + `weight` of each head · its numbers.
#[inline(always)]
pub(super) fn accumulate<S: Simd>(simd: S, sum: Vectors<S>, weight: Floats<S>, numbers: Vectors<S>) -> Vectors<S> {
    let (mut sum, weights) = (sum, simd.spread_each(weight));
    for part in 0..DEPTH {
        sum[part] = simd.mul_add(weights[part], numbers[part], sum[part]);
    }
    sum
}

/// `weight` of each head · its numbers.
#[inline(always)]
pub(super) fn weighted<S: Simd>(simd: S, weight: Floats<S>, numbers: Vectors<S>) -> Vectors<S> {
    let (mut result, weights) = (numbers, simd.spread_each(weight));
    for part in 0..DEPTH {
        result[part] = simd.mul(weights[part], numbers[part]);
    }
    result
}

/// Sets `powers` to 2^(score − largest score) for all tokens, the newest token last. Returns 1 over their sum.
#[inline(always)]
pub(super) fn soften<S: Simd>(
    simd: S,
    place: SixteenHeads,
    query: &[Quad],
    cache: &[KeyValue<'_>],
    newest: KeyValue<'_>,
    powers: &mut Vec<Lanes>,
    prefetched: bool,
) -> Floats<S> {
    powers.resize(cache.len() + 1, Lanes::ZERO);
    let mut largest = simd.splat(f32::NEG_INFINITY);
    for (token, power) in cache.iter().chain([&newest]).zip(powers.iter_mut()) {
        if prefetched && place.whole() {
            place.prefetch(simd, token.key);
            place.prefetch(simd, token.value);
        }
        let mut score = simd.splat(0.0);
        for (quad, query) in query.iter().enumerate() {
            score = dot(simd, simd.read(query), place.load(simd, token.key, quad), score);
        }
        largest = simd.max(largest, score);
        simd.store(score, &mut power.0);
    }
    let mut sum = simd.splat(0.0);
    for power in powers {
        let value = simd.exp2(simd.sub(simd.load(&power.0), largest));
        sum = simd.add(sum, value);
        simd.store(value, &mut power.0);
    }
    simd.div(simd.splat(1.0), sum)
}
