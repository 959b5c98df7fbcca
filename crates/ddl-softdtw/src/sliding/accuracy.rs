//! Accuracy of the `f32` sums of [`crate::sliding::kernel`].

use crate::range::{self, Range};

/// Largest cost of a cell (log2 units). Larger costs are clamped to it.
pub(super) const COST_CEILING: f32 = 86.0;
/// Added to every cell of the recursion: 2^−39. Its product with 2^−`COST_CEILING` is a normal number.
pub(super) const FLOOR: f32 = f32::from_bits((127 - 39) << 23);

const UNIT: f64 = 1.0 / (1u64 << 24) as f64;
/// log2 of the factor by which an accurate score must exceed the error of ceiling and floor.
const HEADROOM_LOG2: f64 = 24.0;

/// Range and error of the scores of windows of one length, in log2 units on the scale of [`Range`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Accuracy {
    range: Range,
    /// The smallest score that is accurate despite the ceiling on costs and the floor of the cells.
    smallest_log2: f64,
    /// Relative roundings of a score beyond those that [`Range`] counts.
    extra_log2: f64,
}

impl Accuracy {
    /// For windows of `length` steps, or `None` if they are too long for `f32`. A pair of windows is cut at a row. Let
    /// m be the last cell of a path in that row. F(m) is the sum over the paths from the first cell of the pair to m,
    /// and B(m) the sum over the paths from m to the last cell of the pair. The score is the sum of F(m) B(m) over m.
    /// Each factor is increased by at most `FLOOR` times the number of paths between any cell and its far end; the
    /// ceiling increases each path by at most 2^−`COST_CEILING`.
    pub(super) fn of(length: usize) -> Option<Self> {
        let range = Range::narrow(range::FLOOR, length, length)?;
        let table = PathTable::new(length);
        let (start, floor) = (f64::from(range.start_log2()), f64::from(FLOOR));
        let (front, back) = halves(range.start_log2());
        let (front, back) = (f64::from(front).exp2(), f64::from(back).exp2());
        let mut worst = 0.0_f64;
        for above in 0..length {
            let mut raised = 0.0;
            for left in 0..length {
                let right = length - 1 - left;
                let (paths, sums) = (table.paths[above][left], table.sums[above][left]);
                let (paths_below, sums_below) = match (length - 1 - above).checked_sub(1) {
                    None => (1.0, 0.0),
                    Some(row) => {
                        let beside = if right == 0 { 0.0 } else { table.paths[row][right - 1] };
                        (table.paths[row][right] + beside, table.sums[row][right])
                    }
                };
                raised += sums * (paths_below * back + sums_below * floor) + paths * front * sums_below;
            }
            worst = worst.max(raised * floor);
        }
        let ceiling = start + table.paths[length - 1][length - 1].log2() - f64::from(COST_CEILING);
        let smallest_log2 = ceiling.max(worst.log2()) + 1.0 + HEADROOM_LOG2;
        // One rounding of F B, one for each of at most `length` additions, and two for the weight.
        let extra_log2 = (length as f64 + 3.0) * UNIT * std::f64::consts::LOG2_E;
        Some(Self {
            range,
            smallest_log2,
            extra_log2,
        })
    }

    /// The start values of the paths before and after the cut. Their product is the start of [`Range`].
    pub(super) fn starts(&self) -> (f32, f32) {
        let (front, back) = halves(self.range.start_log2());
        (f32::from(front).exp2(), f32::from(back).exp2())
    }

    #[cfg(test)]
    pub(super) fn start_log2(&self) -> f64 {
        f64::from(self.range.start_log2())
    }

    pub(super) fn smallest_accurate_log2(&self) -> f64 {
        self.smallest_log2
    }

    #[cfg(test)]
    pub(super) fn error_log2(&self, score_log2: f64, largest: f64, dimension: usize) -> f64 {
        self.range.error_log2(score_log2, largest, dimension) + self.extra_log2
    }

    /// Width of the band below the n-th score that may hold members of the true n best, as [`Range::margin_log2`].
    pub(super) fn margin_log2(&self, score_log2: f64, largest: f64, dimension: usize) -> Option<f64> {
        let margin = self.range.margin_log2(score_log2, largest, dimension)?;
        Some(margin + 2.0 * self.extra_log2)
    }
}

/// A start as two factors of about the same size.
fn halves(start_log2: i16) -> (i16, i16) {
    (start_log2 / 2, start_log2 - start_log2 / 2)
}

/// Delannoy numbers: `paths[r][c]` warping paths lead r rows down and c columns across.
struct PathTable {
    paths: Vec<Vec<f64>>,
    /// Sums of `paths` over all smaller or equal r and c.
    sums: Vec<Vec<f64>>,
}

impl PathTable {
    fn new(length: usize) -> Self {
        let mut paths = vec![vec![1.0_f64; length]; length];
        for r in 1..length {
            for c in 1..length {
                paths[r][c] = paths[r - 1][c] + paths[r - 1][c - 1] + paths[r][c - 1];
            }
        }
        let sum = |r: usize, c: usize| paths[..=r].iter().flat_map(|row| &row[..=c]).sum();
        let sums = (0..length).map(|r| (0..length).map(|c| sum(r, c)).collect()).collect();
        Self { paths, sums }
    }
}

#[cfg(test)]
mod tests {
    use super::{Accuracy, COST_CEILING, FLOOR};

    #[test]
    fn pedestrians_have_room_for_values_of_28_gamma() {
        for length in [7, 8] {
            let accuracy = Accuracy::of(length).expect("short");
            let reach = accuracy.start_log2() - accuracy.smallest_accurate_log2();
            assert!(reach * std::f64::consts::LN_2 > 28.0, "{length}: {reach}");
        }
        assert!(Accuracy::of(33).is_none());
        let product = FLOOR * (-COST_CEILING).exp2();
        assert!(product.is_normal(), "{product:e}");
    }
}
