//! Accuracy of the recursion in the exponential domain in `f32`: its range and its rounding error.
//!
//! All quantities are in log2 units: a score Z represents the soft-DTW value −γ ln 2 · log2(Z / start).

use ddl_simd::InstructionSet;

/// Magnitude of the smallest exponent of a similarity; smaller exponents are clamped, so that no power of two
/// is denormal.
pub(crate) const COST_LIMIT: f32 = 124.0;
/// Added to every product of a similarity and predecessors: 2^−100. A fused product that is added to it is not
/// first rounded to a denormal number.
pub(crate) const FUSED_FLOOR: f32 = f32::from_bits((127 - 100) << 23);
/// Added to every sum of predecessors by [`InstructionSet::Portable`], where products may be rounded on their
/// own. Its product with 2^−[`COST_LIMIT`] is a normal number.
pub(crate) const UNFUSED_FLOOR: f32 = 0.25;

/// Bound on the relative error of a power of two ([`ddl_simd::exp2_each`]).
const EXP2_ERROR: f64 = 3e-7;

const UNIT: f64 = 1.0 / (1u64 << 24) as f64;
/// Largest margin (log2 units). With a larger one, the sieve would keep nearly every candidate.
const WIDEST_MARGIN: f64 = 0.25;

/// Most steps of a sequence.
const LONGEST: usize = 32;
/// log2 of the largest number, minus two for rounding and for the sums of three terms.
const TOP: f64 = 125.0;
/// log2 of the factor by which an accurate score must exceed the error of clamp and floor.
const HEADROOM: f64 = 24.0;

/// The range of the recursion for a query of n steps against candidates of up to m steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range {
    /// The number that is added to a sum of predecessors, or to its product.
    floor: f64,
    /// log2 of the number of warping paths (a Delannoy number), which bounds Z / start.
    paths_log2: f64,
    /// log2 of the number of paths from a cell to the last one, summed over all cells.
    tails_log2: f64,
    /// log2 of the start value of the recursion: as large as the number of paths allows.
    pub(crate) start_log2: i16,
    longest_path: f64,
}

impl Range {
    /// The range for lengths `n` and `m` on `set`, or `None` when the sequences are too long for it.
    pub(crate) fn new(set: InstructionSet, n: usize, m: usize) -> Option<Self> {
        if n.max(m) > LONGEST {
            return None;
        }
        let floor = match set {
            InstructionSet::Portable => UNFUSED_FLOOR,
            _ => FUSED_FLOOR,
        };
        let (paths, tails) = delannoy(n, m);
        let paths_log2 = paths.log2();
        Some(Self {
            floor: f64::from(floor),
            paths_log2,
            tails_log2: tails.log2(),
            start_log2: (TOP - paths_log2.ceil()) as i16,
            longest_path: (n + m - 1) as f64,
        })
    }

    /// The smallest score (log2, start included) that is accurate despite the clamp on costs and the floor on sums.
    /// Each of the at most `paths` paths gains at most 2^−[`COST_LIMIT`] by the clamp, and each cell passes on at most
    /// `floor` times the number of paths from it to the last cell.
    pub(crate) fn smallest_accurate_log2(&self) -> f64 {
        let start = f64::from(self.start_log2);
        let clamp = start + self.paths_log2 - f64::from(COST_LIMIT);
        clamp.max(self.floor.log2() + self.tails_log2) + 1.0 + HEADROOM
    }

    /// Bound on the error of log2(score) for scores of at least `score_log2` (start included), for inputs of
    /// absolute value up to `largest` and dimension `dimension`. Paths whose cost C exceeds
    /// `paths + (start − score) + 30` contribute less than 2^−30 of the score. For the others, let e = largest · u be
    /// the input error. By the Cauchy-Schwarz inequality, the squared differences of a path of P cells have an error of
    /// at most 4 e √(P·dim·C) + 4 e² P dim (inputs) + (dim + 3) u C (rounding). Each cell adds the error of exp2 and
    /// four roundings.
    pub(crate) fn error_log2(&self, score_log2: f64, largest: f64, dimension: usize) -> f64 {
        let (path, dimension) = (self.longest_path, dimension as f64);
        let cost = self.cost_log2(score_log2);
        let input = largest * UNIT;
        let spread = path * dimension;
        let costs =
            4.0 * input * (spread * cost).sqrt() + 4.0 * input * input * spread + (dimension + 3.0) * UNIT * cost;
        let cells = path * (EXP2_ERROR + 4.0 * UNIT) * std::f64::consts::LOG2_E;
        let tails = 2.0_f64.powf(-HEADROOM) * 3.0;
        costs + cells + tails
    }

    /// Width of the band below the n-th score that may hold members of the true n best; `None` if it is so wide that
    /// the sieve is useless. It is twice the error, because the n-th score and that of a candidate may both be wrong.
    /// The error of the `f64` values is added, so that excluded candidates are farther than the n-th neighbour in
    /// computed values too.
    pub(crate) fn margin_log2(&self, score_log2: f64, largest: f64, dim: usize) -> Option<f64> {
        // A candidate just inside the band has a slightly lower score than the n-th; one unit covers the difference.
        let score_log2 = score_log2 - 1.0;
        // The bound of `SoftDtw`, in log2 units.
        let size = self.cost_log2(score_log2) + (self.longest_path + 1.0) * std::f64::consts::LOG2_E;
        let refined = (dim as f64 + 12.0) * f64::EPSILON / 2.0 * size;
        let margin = 2.0 * (self.error_log2(score_log2, largest, dim) + refined);
        (margin <= WIDEST_MARGIN).then_some(margin)
    }

    /// Cost above which paths contribute less than 2^−30 of a score.
    fn cost_log2(&self, score_log2: f64) -> f64 {
        self.paths_log2 + (f64::from(self.start_log2) - score_log2).max(0.0) + 30.0
    }
}

/// Number of warping paths through an n × m grid, and the sum of that number over all sub-grids that share its end.
fn delannoy(n: usize, m: usize) -> (f64, f64) {
    let mut row = vec![1.0_f64; m];
    let mut total = m as f64;
    for _ in 1..n {
        let mut diagonal = row[0];
        for j in 1..m {
            let up = row[j];
            row[j] = diagonal + up + row[j - 1];
            diagonal = up;
        }
        total += row.iter().sum::<f64>();
    }
    (row.last().copied().unwrap_or(1.0), total)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "exact values are what is claimed")]

    use ddl_simd::InstructionSet;

    use super::{LONGEST, Range, delannoy};

    #[test]
    fn paths_are_the_central_delannoy_numbers() {
        assert_eq!(delannoy(1, 1), (1.0, 1.0));
        assert_eq!(delannoy(2, 2), (3.0, 6.0));
        assert_eq!(delannoy(7, 7).0, 8989.0);
        assert_eq!(delannoy(8, 8).0, 48639.0);
        assert_eq!(delannoy(1, 9), (1.0, 9.0));
    }

    #[test]
    fn pedestrians_have_room_for_values_of_57_gamma_or_47_if_portable() {
        for (set, gammas) in [(InstructionSet::Avx2, 57.0), (InstructionSet::Portable, 47.0)] {
            let range = Range::new(set, 8, 8).expect("short");
            let log2 = f64::from(range.start_log2) - range.smallest_accurate_log2();
            assert!(log2 * std::f64::consts::LN_2 > gammas);
            assert!(Range::new(set, LONGEST + 1, 8).is_none());
        }
    }
}
