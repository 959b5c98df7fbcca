//! The layout of heads in lanes: eight heads of each of two pedestrians, four of their numbers (a quad) at a time.

use ddl_simd::{DEPTH, HALF, HalfQuad, Simd, Vectors};

pub(super) const GROUP: usize = HALF;

/// Four numbers of each head of a group in one row, a half of a vector at a time.
type Halves = [[f32; HALF]; DEPTH];
const ZERO_HALVES: Halves = HalfQuad::ZERO.0;

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
    /// Lane l holds head `head_of(l)` of the group, from row `row_of(l)`. In this order, transposing pieces of four
    /// lanes is enough.
    #[inline(always)]
    pub(super) fn load<S: Simd>(self, simd: S, first: &[f32], second: Option<&[f32]>) -> Vectors<S> {
        if let Some(a) = self.whole(first)
            && let Some(b) = second.map_or(Some(&ZERO_HALVES), |row| self.whole(row))
        {
            return loaded(simd, a, b);
        }
        let b = second.map_or(ZERO_HALVES, |row| self.gathered(row));
        loaded(simd, &self.gathered(first), &b)
    }

    #[inline(always)]
    pub(super) fn store<S: Simd>(self, simd: S, vectors: Vectors<S>, first: &mut [f32], second: Option<&mut [f32]>) {
        let [mut a, mut b] = [HalfQuad::ZERO; 2];
        simd.write_halves(simd.transpose(vectors), &mut a, &mut b);
        self.store_row(&a.0, first);
        if let Some(second) = second {
            self.store_row(&b.0, second);
        }
    }

    /// Stores the sums of the numbers of both rows.
    #[inline(always)]
    pub(super) fn store_sum<S: Simd>(self, simd: S, vectors: Vectors<S>, row: &mut [f32]) {
        let [mut a, mut b] = [HalfQuad::ZERO; 2];
        simd.write_halves(simd.transpose(vectors), &mut a, &mut b);
        for (a, b) in a.0.as_flattened_mut().iter_mut().zip(b.0.as_flattened()) {
            *a += b;
        }
        self.store_row(&a.0, row);
    }

    #[inline(always)]
    fn store_row(self, numbers: &Halves, row: &mut [f32]) {
        if let Some(whole) = self.whole_mut(row) {
            *whole = *numbers;
        } else {
            self.for_each(|place, index| row[index] = numbers.as_flattened()[place]);
        }
    }

    #[inline(always)]
    fn gathered(self, row: &[f32]) -> Halves {
        let mut numbers = ZERO_HALVES;
        self.for_each(|place, index| numbers.as_flattened_mut()[place] = row[index]);
        numbers
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
    fn for_each(self, mut f: impl FnMut(usize, usize)) {
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

/// Which of two rows a lane holds.
pub(super) const fn row_of(lane: usize) -> usize {
    lane / GROUP
}

/// Which head of a group a lane holds.
pub(super) const fn head_of(lane: usize) -> usize {
    2 * (lane % DEPTH) + lane % GROUP / DEPTH
}
