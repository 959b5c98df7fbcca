//! Rows of heads in lanes: eight heads each of two walkers, in blocks of four of their numbers.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::lanes::{DEPTH, LANES, Lanes, Vectors};

/// Heads of a walker that are computed together.
pub(crate) const GROUP: usize = LANES / 2;

/// Number and width of the heads of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Heads {
    pub(crate) count: usize,
    pub(crate) width: usize,
}

impl Heads {
    /// # Panics
    /// When there are no heads or more than 256, or they have no width.
    pub(crate) fn new(count: usize, width: usize) -> Self {
        assert!(
            (1..=256).contains(&count) && width > 0,
            "{count} heads of width {width}: 1 to 256 heads are needed, of at least one number"
        );
        Self { count, width }
    }

    /// Numbers in a row.
    pub(crate) fn row(self) -> usize {
        self.count * self.width
    }

    /// Groups of heads in a row.
    pub(crate) fn groups(self) -> usize {
        self.count.div_ceil(GROUP)
    }

    /// Blocks that hold a head.
    pub(crate) fn blocks(self) -> usize {
        self.width.div_ceil(DEPTH)
    }

    /// 1 / √width, which keeps the variance of scores.
    pub(crate) fn scale(self) -> f32 {
        (1.0 / (self.width as f64).sqrt()) as f32
    }
}

/// A part of the numbers of a row: [`GROUP`] heads and [`DEPTH`] numbers of each.
///
/// Heads that lack in the last group and numbers that lack in the last block are 0 when loaded, and not stored.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    heads: Heads,
    group: usize,
    block: usize,
}

impl Part {
    #[inline(always)]
    pub(crate) fn new(heads: Heads, group: usize, block: usize) -> Self {
        Self {
            heads,
            group,
            block,
        }
    }

    /// Heads of two rows side by side; a missing row counts as zeros.
    #[inline(always)]
    pub(crate) fn load(self, first: &[f32], second: Option<&[f32]>) -> Vectors {
        let mut block = [Lanes::ZERO; DEPTH];
        self.load_half::<0>(first, &mut block);
        if let Some(second) = second {
            self.load_half::<GROUP>(second, &mut block);
        }
        block
    }

    #[inline(always)]
    fn load_half<const OFFSET: usize>(self, row: &[f32], into: &mut Vectors) {
        if let Some(numbers) = self.whole(row) {
            for d in 0..DEPTH {
                for head in 0..GROUP {
                    into[d].0[OFFSET + head] = numbers[head * DEPTH + d];
                }
            }
        } else {
            self.each(|head, d, at| into[d].0[OFFSET + head] = row[at]);
        }
    }

    /// Sets the numbers of a row to `factor` times those of lanes `OFFSET ..`.
    #[inline(always)]
    pub(crate) fn store<const OFFSET: usize>(self, from: &Vectors, row: &mut [f32]) {
        if let Some(numbers) = self.whole_mut(row) {
            for head in 0..GROUP {
                for d in 0..DEPTH {
                    numbers[head * DEPTH + d] = from[d].0[OFFSET + head];
                }
            }
        } else {
            self.each(|head, d, at| row[at] = from[d].0[OFFSET + head]);
        }
    }

    /// Sums over the numbers of each head of a · b, added to `sums`.
    #[inline(always)]
    pub(crate) fn dot_half<const OFFSET: usize>(self, a: &[f32], b: &[f32], sums: &mut Lanes) {
        if let (Some(a), Some(b)) = (self.whole(a), self.whole(b)) {
            let mut products = [0.0; GROUP * DEPTH];
            for i in 0..GROUP * DEPTH {
                products[i] = a[i] * b[i];
            }
            for head in 0..GROUP {
                let at = head * DEPTH;
                sums.0[OFFSET + head] +=
                    (products[at] + products[at + 1]) + (products[at + 2] + products[at + 3]);
            }
        } else {
            self.each(|head, _, at| sums.0[OFFSET + head] += a[at] * b[at]);
        }
    }

    /// The part as one array, where nothing lacks and nothing lies between.
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

    /// Head within the group, number within the block, and the place of the number in the row.
    #[inline(always)]
    fn each(self, mut f: impl FnMut(usize, usize, usize)) {
        let first = self.group * GROUP;
        let numbers = self.block * DEPTH..self.heads.width.min((self.block + 1) * DEPTH);
        for head in first..self.heads.count.min(first + GROUP) {
            for number in numbers.clone() {
                let at = head * self.heads.width + number;
                f(head - first, number - self.block * DEPTH, at);
            }
        }
    }
}
