//! The recursion of soft-DTW in the exponential domain, four rows at a time along antidiagonals.
//!
//! With R(i, j) = exp(−r(i, j)/γ) the smoothed minimum is a sum,
//!
//! ```text
//! R(i, j) = 2^−t(i, j) · ( R(i−1, j−1) + R(i−1, j) + R(i, j−1) ),   t = δ log2(e) / γ,
//! ```
//!
//! so a cell needs one exponential, which no other cell waits for, and no logarithm. R is far out of the range of `f64`
//! for all but short sequences, so it is held as `significand · 2^exponent` with the exponent in a number of its own: the
//! sum of the whole parts of t along the cheapest path, an exact integer. Terms are aligned by exact powers of two, all of
//! them are positive, nothing cancels: each cell adds a few units of roundoff to the relative error of R, and no range of
//! costs is lost. See [`error_bound`].
//!
//! Four consecutive rows (a strip) advance together, each one column behind the row above it: the cells of a step are
//! independent of each other, which hides the latency of the recursion and lets the compiler use vector instructions. One
//! row is kept between strips.

use crate::cost::{Cost, Length, Metric, Squared};
use crate::exp2::{LANES, Lanes, ROUNDING, exp2_minus};
use crate::grid::{Grid, Strip};
use crate::scalar::Scalar;

/// Exponent of a cell that no path reaches: far below every other, far from overflow.
const NOTHING: f64 = -1_152_921_504_606_846_976.0; // −2^60
/// An addend 2^700 below the largest counts as that far below: it does not change the sum, and stays a normal number.
const FARTHEST: f64 = -700.0;
/// Exponents are exact integers while the whole parts of all t along a path sum to no more than this.
const EXACT: f64 = 4_503_599_627_370_496.0; // 2^52
/// Significands are brought back to [1, 2) every so many columns and rows. Between two of these a path has at most 2 · 128
/// cells, an antidiagonal each, and each multiplies the significand by 2^−1/2 to (1 + √2) √2 < 2^1.78: in all by
/// 2^−128 to 2^456, which leaves room for [`FARTHEST`] below.
const STRETCH: usize = 128;

/// Cells of one antidiagonal of a strip, or one of them: significand · 2^exponent.
#[derive(Clone, Copy)]
struct Scaled<V> {
    significand: V,
    exponent: V,
}

const EMPTY: Scaled<f64> = Scaled {
    significand: 1.0,
    exponent: NOTHING,
};
const EMPTY_LANES: Scaled<Lanes> = Scaled {
    significand: [1.0; LANES],
    exponent: [NOTHING; LANES],
};

impl Scaled<f64> {
    /// The same number with the significand in [1, 2).
    fn normalised(self) -> Self {
        let bits = self.significand.to_bits();
        let shift = (bits >> 52) as f64 - 1023.0;
        Self {
            significand: f64::from_bits((bits & (u64::MAX >> 12)) | 1.0_f64.to_bits()),
            exponent: self.exponent + shift,
        }
    }
}

impl Scaled<Lanes> {
    /// Each number with its significand in [1, 2). By value: behind a reference the lanes would not stay in registers.
    #[inline(never)]
    fn normalised(mut self) -> Self {
        for l in 0..LANES {
            let lane = Scaled {
                significand: self.significand[l],
                exponent: self.exponent[l],
            };
            let lane = lane.normalised();
            self.significand[l] = lane.significand;
            self.exponent[l] = lane.exponent;
        }
        self
    }

    /// The lanes moved down by one row, `top` above them.
    #[inline(always)]
    fn below(&self, top: Scaled<f64>) -> Self {
        let (s, e) = (&self.significand, &self.exponent);
        Self {
            significand: [top.significand, s[0], s[1], s[2]],
            exponent: [top.exponent, e[0], e[1], e[2]],
        }
    }
}

/// Rows of the working memory that fit on the stack.
const SHORT: usize = 32;

/// Receives, for each step of each strip, the addends of its cells (from (i−1, j−1), (i−1, j), (i, j−1)) and their sums.
pub(crate) trait Record {
    fn step(&mut self, addends: &[Lanes; 3], sums: &Lanes);
}

/// Keeps nothing.
pub(crate) struct Forget;

impl Record for Forget {
    #[inline(always)]
    fn step(&mut self, _: &[Lanes; 3], _: &Lanes) {}
}

impl<T: Scalar, const D: usize> Grid<'_, T, D> {
    /// The soft-DTW value, or `None` where costs are so large against γ that the log domain must be used.
    pub(crate) fn value(&self, record: &mut impl Record) -> Option<f64> {
        let scale = std::f64::consts::LOG2_E / self.gamma;
        if !scale.is_finite() {
            return None;
        }
        // Entry c + 3 is column c. A step reads entry d + 3 (column d) for its first lane and writes entry d (column d − 3)
        // from its last; three entries before and after the columns take what the slanted ends of a strip read and write.
        let length = self.columns.len() + 2 * (LANES - 1);
        let (end, largest) = if length <= SHORT {
            self.run(scale, &mut [EMPTY; SHORT][..length], record)
        } else {
            self.run(scale, &mut vec![EMPTY; length], record)
        };
        let path = (self.rows.len() + self.columns.len()) as f64;
        // Not `largest * path > EXACT`: an infinite cost must end here too.
        (largest * path <= EXACT).then(|| {
            let end = end.normalised();
            -self.gamma * (end.exponent * std::f64::consts::LN_2 + end.significand.ln())
        })
    }

    /// R of the last cell, and the largest t.
    fn run(
        &self,
        scale: f64,
        row: &mut [Scaled<f64>],
        record: &mut impl Record,
    ) -> (Scaled<f64>, f64) {
        let mut largest = [0.0; LANES];
        for index in 0..self.strips() {
            let strip = self.strip(index);
            let t_max = &mut largest;
            match (self.cost, self.band) {
                (Cost::SquaredEuclidean, None) => {
                    self.advance::<_, false>(Squared, &strip, scale, row, t_max, record);
                }
                (Cost::SquaredEuclidean, Some(_)) => {
                    self.advance::<_, true>(Squared, &strip, scale, row, t_max, record);
                }
                (Cost::Euclidean, None) => {
                    self.advance::<_, false>(Length, &strip, scale, row, t_max, record);
                }
                (Cost::Euclidean, Some(_)) => {
                    self.advance::<_, true>(Length, &strip, scale, row, t_max, record);
                }
            }
            if (index + 1) % (STRETCH / LANES) == 0 {
                row.iter_mut().for_each(|cell| *cell = cell.normalised());
            }
        }
        let end = row[self.columns.len() + LANES - 2];
        (end, largest.into_iter().fold(0.0, f64::max))
    }

    /// One strip: `row` holds the row above it before, its last row after.
    #[inline(always)]
    fn advance<M: Metric, const BANDED: bool>(
        &self,
        metric: M,
        strip: &Strip<D>,
        scale: f64,
        row: &mut [Scaled<f64>],
        largest: &mut Lanes,
        record: &mut impl Record,
    ) {
        let (start, end) = (strip.start, strip.end);
        let row = &mut row[..end + LANES];
        let mut cells = EMPTY_LANES;
        let mut diagonal = EMPTY_LANES.below(row[start + LANES - 2]);
        if let Some(corner) = strip.corner {
            for l in 0..LANES {
                diagonal.exponent[l] = if l == corner { 0.0 } else { NOTHING };
            }
        }
        let mut tmax = *largest;
        let mut y = self.window(start);
        let mut next = start;
        while next <= end {
            let stop = end.min(next | (STRETCH - 1));
            for d in next..=stop {
                if d > start {
                    y = [self.column(d, 0), y[0], y[1], y[2]];
                }
                let mut t = [0.0; LANES];
                for l in 0..LANES {
                    t[l] = metric.between(&strip.x[l], &y[l]) * scale;
                }
                let up = cells.below(row[d + LANES - 1]);
                let (addends, top) = aligned(&diagonal, &up, &cells);
                let (whole, power) = exp2_minus(&t);
                let mut sums = [0.0; LANES];
                for l in 0..LANES {
                    // The first two are added first: so (y, x) gives the same bits as (x, y).
                    sums[l] = (addends[1][l] + addends[2][l]) + addends[0][l];
                    cells.significand[l] = power[l] * sums[l];
                    cells.exponent[l] = top[l] - whole[l];
                }
                if BANDED {
                    let step = d as f64;
                    for l in 0..LANES {
                        let inside = strip.first[l] <= step && step <= strip.last[l];
                        cells.exponent[l] = if inside { cells.exponent[l] } else { NOTHING };
                        t[l] = if inside { t[l] } else { 0.0 };
                    }
                }
                for l in 0..LANES {
                    tmax[l] = if t[l] > tmax[l] { t[l] } else { tmax[l] };
                }
                record.step(&addends, &sums);
                diagonal = up;
                row[d] = Scaled {
                    significand: cells.significand[LANES - 1],
                    exponent: cells.exponent[LANES - 1],
                };
            }
            cells = cells.normalised();
            diagonal = diagonal.normalised();
            next = stop + 1;
        }
        *largest = tmax;
    }
}

/// The three ways into each cell, scaled by one power of two a cell, and that power: the largest of the exponents.
#[inline(always)]
fn aligned(
    diagonal: &Scaled<Lanes>,
    up: &Scaled<Lanes>,
    left: &Scaled<Lanes>,
) -> ([Lanes; 3], Lanes) {
    let mut top = [0.0; LANES];
    for l in 0..LANES {
        let (a, b, c) = (diagonal.exponent[l], up.exponent[l], left.exponent[l]);
        let bc = if b > c { b } else { c };
        top[l] = if a > bc { a } else { bc };
    }
    let mut addends = [[0.0; LANES]; 3];
    for (addend, term) in addends.iter_mut().zip([diagonal, up, left]) {
        for l in 0..LANES {
            let shift = term.exponent[l] - top[l];
            let shift = if shift > FARTHEST { shift } else { FARTHEST };
            // The low bits of the sum are the shift; moved to the place of the exponent they multiply by 2^shift.
            let shift = (shift + ROUNDING).to_bits() << 52;
            addend[l] = f64::from_bits(term.significand[l].to_bits().wrapping_add(shift));
        }
    }
    (addends, top)
}
