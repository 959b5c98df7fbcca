//! The layout of heads in lanes: eight heads of each of two pedestrians, four of their numbers (a quad) at a time.

use ddl_simd::{DEPTH, LANES, Simd, Vectors};

pub(super) const GROUP: usize = LANES / 2;

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
    /// Lane l holds head l / 4 + 4 (l mod 2) of row (l mod 4) / 2. In this order, transposing pieces of four lanes is
    /// enough.
    #[inline(always)]
    pub(super) fn load<S: Simd>(self, simd: S, first: &[f32], second: Option<&[f32]>) -> Vectors<S> {
        let [a, b] = self.row(simd, first);
        let [c, d] = match second {
            Some(second) => self.row(simd, second),
            None => [simd.splat(0.0); 2],
        };
        simd.transpose([a, b, c, d])
    }

    #[inline(always)]
    pub(super) fn store<S: Simd>(self, simd: S, vectors: Vectors<S>, first: &mut [f32], second: Option<&mut [f32]>) {
        let [a, b, c, d] = simd.transpose(vectors);
        self.store_row(simd, [a, b], first);
        if let Some(second) = second {
            self.store_row(simd, [c, d], second);
        }
    }

    #[inline(always)]
    pub(super) fn store_sum<S: Simd>(self, simd: S, vectors: Vectors<S>, row: &mut [f32]) {
        let [a, b, c, d] = simd.transpose(vectors);
        self.store_row(simd, [simd.add(a, c), simd.add(b, d)], row);
    }

    #[inline(always)]
    fn row<S: Simd>(self, simd: S, row: &[f32]) -> [S::Floats; 2] {
        let mut gathered = [0.0; GROUP * DEPTH];
        let numbers = if let Some(whole) = self.whole(row) {
            whole
        } else {
            self.each(|place, at| gathered[place] = row[at]);
            &gathered
        };
        let halves = numbers.as_chunks().0;
        [simd.load(&halves[0]), simd.load(&halves[1])]
    }

    #[inline(always)]
    fn store_row<S: Simd>(self, simd: S, values: [S::Floats; 2], row: &mut [f32]) {
        if let Some(whole) = self.whole_mut(row) {
            let halves = whole.as_chunks_mut().0;
            simd.store(values[0], &mut halves[0]);
            simd.store(values[1], &mut halves[1]);
        } else {
            let mut numbers = [0.0; GROUP * DEPTH];
            let halves = numbers.as_chunks_mut().0;
            simd.store(values[0], &mut halves[0]);
            simd.store(values[1], &mut halves[1]);
            self.each(|place, at| row[at] = numbers[place]);
        }
    }

    #[inline(always)]
    fn whole(self, row: &[f32]) -> Option<&[f32; GROUP * DEPTH]> {
        if self.heads.width != DEPTH {
            return None;
        }
        row.get(self.group * GROUP * DEPTH..)?.first_chunk()
    }

    #[inline(always)]
    fn whole_mut(self, row: &mut [f32]) -> Option<&mut [f32; GROUP * DEPTH]> {
        if self.heads.width != DEPTH {
            return None;
        }
        row.get_mut(self.group * GROUP * DEPTH..)?.first_chunk_mut()
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

pub(super) const fn row_of(lane: usize) -> usize {
    lane % 4 / 2
}

pub(super) const fn head_of(lane: usize) -> usize {
    lane / 4 + 4 * (lane % 2)
}
