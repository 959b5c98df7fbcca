//! The layout of heads in lanes: eight heads of each of two pedestrians, four of their numbers (a quad) at a time.

use ddl_simd::{DEPTH, HALF, Simd, Vectors};

pub(super) const GROUP: usize = HALF;

/// The numbers of a group of heads in one row, a half of a vector at a time.
type Halves = [[f32; HALF]; DEPTH];
const ZERO_HALVES: Halves = [[0.0; HALF]; DEPTH];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Heads {
    pub(super) count: usize,
    pub(super) width: usize,
}

impl Heads {
    pub(super) fn new(count: usize, width: usize) -> Self {
        assert!(
            (1..=256).contains(&count) && width > 0,
            "{count} heads of width {width}: 1 to 256 heads are needed, of at least one number"
        );
        Self { count, width }
    }

    pub(super) fn row(self) -> usize {
        self.count * self.width
    }

    pub(super) fn groups(self) -> usize {
        self.count.div_ceil(GROUP)
    }

    pub(super) fn quads(self) -> usize {
        self.width.div_ceil(DEPTH)
    }

    /// 1 / √width, so that the variance of scores does not depend on the width.
    pub(super) fn scale(self) -> f32 {
        (1.0 / (self.width as f64).sqrt()) as f32
    }
}

/// A part of the numbers of a row: [`GROUP`] heads and [`DEPTH`] numbers of each.
///
/// Heads beyond the last and numbers beyond the width are loaded as 0 and not stored.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeadPart {
    heads: Heads,
    group: usize,
    quad: usize,
}

impl HeadPart {
    #[inline(always)]
    pub(super) fn new(heads: Heads, group: usize, quad: usize) -> Self {
        Self { heads, group, quad }
    }

    /// Loads the heads of two rows; a missing row counts as zeros. Vector d holds the d-th number of each head.
    ///
    /// Lane l holds head [`head_of`] l of row [`row_of`] l. In this order, transposing pieces of four lanes is enough.
    #[inline(always)]
    pub(super) fn load<S: Simd>(self, simd: S, first: &[f32], second: Option<&[f32]>) -> Vectors<S> {
        if let Some(a) = self.whole(first)
            && let Some(b) = second.map_or(Some(&ZERO_HALVES), |row| self.whole(row))
        {
            return loaded(simd, a, b);
        }
        let [mut a, mut b] = [ZERO_HALVES; 2];
        self.each(|place, at| a.as_flattened_mut()[place] = first[at]);
        if let Some(second) = second {
            self.each(|place, at| b.as_flattened_mut()[place] = second[at]);
        }
        loaded(simd, &a, &b)
    }

    #[inline(always)]
    pub(super) fn store<S: Simd>(self, simd: S, vectors: Vectors<S>, first: &mut [f32], second: Option<&mut [f32]>) {
        let (mut none, mut second) = (ZERO_HALVES, second);
        if let Some(a) = self.whole_mut(first)
            && let Some(b) = second.as_deref_mut().map_or(Some(&mut none), |row| self.whole_mut(row))
        {
            return stored(simd, vectors, a, b);
        }
        let [mut a, mut b] = [ZERO_HALVES; 2];
        stored(simd, vectors, &mut a, &mut b);
        self.each(|place, at| first[at] = a.as_flattened()[place]);
        if let Some(second) = second {
            self.each(|place, at| second[at] = b.as_flattened()[place]);
        }
    }

    /// Stores the sums of the numbers of both rows.
    #[inline(always)]
    pub(super) fn store_sum<S: Simd>(self, simd: S, vectors: Vectors<S>, row: &mut [f32]) {
        let [mut a, mut b] = [ZERO_HALVES; 2];
        stored(simd, vectors, &mut a, &mut b);
        for (a, b) in a.as_flattened_mut().iter_mut().zip(b.as_flattened()) {
            *a += b;
        }
        if let Some(whole) = self.whole_mut(row) {
            *whole = a;
        } else {
            self.each(|place, at| row[at] = a.as_flattened()[place]);
        }
    }

    #[inline(always)]
    fn whole(self, row: &[f32]) -> Option<&Halves> {
        if self.heads.width != DEPTH {
            return None;
        }
        row.as_chunks().0.get(self.group * DEPTH..)?.first_chunk()
    }

    #[inline(always)]
    fn whole_mut(self, row: &mut [f32]) -> Option<&mut Halves> {
        if self.heads.width != DEPTH {
            return None;
        }
        row.as_chunks_mut().0.get_mut(self.group * DEPTH..)?.first_chunk_mut()
    }

    #[inline(always)]
    fn each(self, mut f: impl FnMut(usize, usize)) {
        let first = self.group * GROUP;
        let numbers = self.quad * DEPTH..self.heads.width.min((self.quad + 1) * DEPTH);
        for head in first..self.heads.count.min(first + GROUP) {
            for number in numbers.clone() {
                let place = (head - first) * DEPTH + number - self.quad * DEPTH;
                f(place, head * self.heads.width + number);
            }
        }
    }
}

#[inline(always)]
fn loaded<S: Simd>(simd: S, low: &Halves, high: &Halves) -> Vectors<S> {
    let mut numbers = [simd.splat(0.0); DEPTH];
    for d in 0..DEPTH {
        numbers[d] = simd.load_halves(&low[d], &high[d]);
    }
    simd.transpose(numbers)
}

#[inline(always)]
fn stored<S: Simd>(simd: S, vectors: Vectors<S>, low: &mut Halves, high: &mut Halves) {
    let numbers = simd.transpose(vectors);
    for d in 0..DEPTH {
        simd.store_halves(numbers[d], &mut low[d], &mut high[d]);
    }
}

pub(super) const fn row_of(lane: usize) -> usize {
    lane / GROUP
}

pub(super) const fn head_of(lane: usize) -> usize {
    2 * (lane % DEPTH) + lane % GROUP / DEPTH
}
