//! The grid of all pairs of steps, cut into strips of a few rows.
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

use std::ops::RangeInclusive;

use crate::band::Band;
use crate::cost::{Cost, Length, Metric as _, Squared};
use crate::lanes::{Lanes, STRIP};
use crate::scalar::{Scalar, widened};

/// For plain numbers: R is at most 2^`LARGEST`, and t at most `LARGEST`.
const LARGEST: f64 = 1018.0;
/// log2(1 + √2), rounded up.
const PATHS: f64 = 1.271_553_303_2;
/// 1018 − 17 − 128: see [`crate::wavefront`].
const ROOM: f64 = 873.0;

/// Two checked sequences and the parameters of their soft-DTW: row i is step i of one, column j step j of the other.
pub(crate) struct Grid<'a, T, const D: usize> {
    pub(crate) rows: &'a [[T; D]],
    pub(crate) columns: &'a [[T; D]],
    pub(crate) gamma: f64,
    pub(crate) cost: Cost,
    pub(crate) band: Option<Band>,
}

/// Consecutive rows that advance together, one per lane, each one column behind the row above it. In step d of the
/// strip, lane l is at column d − l.
pub(crate) struct Strip<const D: usize> {
    /// The rows' steps, component by component. Lanes above the first row repeat it.
    pub(crate) x: [Lanes; D],
    /// First and last step in which some lane is at a column of the grid (and of the band).
    pub(crate) start: usize,
    pub(crate) end: usize,
    /// First and last step in which each lane is in the band; not used without a band.
    pub(crate) first: Lanes,
    pub(crate) last: Lanes,
    /// The lane of row 0, in the strip that holds it: every path starts there, in step `start`.
    pub(crate) corner: Option<usize>,
}

impl<T: Scalar, const D: usize> Grid<'_, T, D> {
    pub(crate) fn band_columns(&self, row: usize) -> RangeInclusive<usize> {
        let (n, m) = (self.rows.len(), self.columns.len());
        self.band.map_or(0..=m - 1, |band| band.columns(row, n, m))
    }

    pub(crate) fn strips(&self) -> usize {
        self.rows.len().div_ceil(STRIP)
    }

    /// Strip `index`. The first one may have fewer rows than lanes, so that the last row is always in the last lane.
    #[inline(always)]
    pub(crate) fn strip(&self, index: usize) -> Strip<D> {
        let (n, m) = (self.rows.len(), self.columns.len());
        let spare = self.strips() * STRIP - n;
        let top = if index == 0 { spare } else { 0 };
        let row = |lane: usize| (index * STRIP + lane).saturating_sub(spare);
        let mut strip = Strip {
            x: [[0.0; STRIP]; D],
            start: top,
            end: m - 1 + STRIP - 1,
            first: [f64::INFINITY; STRIP],
            last: [0.0; STRIP],
            corner: (index == 0).then_some(spare),
        };
        for lane in 0..STRIP {
            let step = widened(&self.rows[row(lane)]);
            for (component, x) in strip.x.iter_mut().zip(step) {
                component[lane] = x;
            }
        }
        if self.band.is_some() {
            for lane in top..STRIP {
                let columns = self.band_columns(row(lane));
                if lane == top {
                    strip.start = columns.start() + lane;
                }
                strip.end = columns.end() + lane;
                strip.first[lane] = (columns.start() + lane) as f64;
                strip.last[lane] = strip.end as f64;
            }
        }
        strip
    }

    /// The factor from a cost to t: log2(e) / γ.
    pub(crate) fn scale(&self) -> f64 {
        std::f64::consts::LOG2_E / self.gamma
    }

    /// The exponent of R(0, 0) with which plain numbers can hold every R, if there is one ([`crate::wavefront`]).
    pub(crate) fn plain_start(&self) -> Option<f64> {
        let (n, m) = (self.rows.len(), self.columns.len());
        let paths = PATHS * (n + m + 2 * STRIP) as f64;
        let start = (LARGEST - paths).floor();
        let room = start - paths + ROOM;
        let bound = self.cost_bound() * self.scale();
        // A bound of all t is cheaper to compute than their sum along a path of n cells, and often sufficient.
        let fits = bound <= LARGEST && (bound * n as f64 <= room || self.diagonal_cost() * self.scale() <= room);
        fits.then_some(start)
    }

    /// The cost of the path next to the diagonal, which is in every band. There are at least as many rows as columns.
    fn diagonal_cost(&self) -> f64 {
        let (steps, rise) = (self.rows.len() - 1, self.columns.len() - 1);
        let (mut column, mut remainder) = (0, steps / 2);
        let mut sum = 0.0;
        for row in self.rows {
            sum += self.cost_between(&widened(row), &widened(&self.columns[column]));
            remainder += rise;
            if remainder >= steps {
                remainder -= steps;
                column += 1;
            }
        }
        sum
    }

    /// A bound of the cost of two steps: that of opposite corners of the box around all steps.
    fn cost_bound(&self) -> f64 {
        let mut low = widened(&self.rows[0]);
        let mut high = low;
        for step in self.rows.iter().chain(self.columns) {
            let step = widened(step);
            for k in 0..D {
                low[k] = if step[k] < low[k] { step[k] } else { low[k] };
                high[k] = if step[k] > high[k] { step[k] } else { high[k] };
            }
        }
        self.cost_between(&low, &high)
    }

    #[inline(always)]
    fn cost_between(&self, a: &[f64; D], b: &[f64; D]) -> f64 {
        match self.cost {
            Cost::SquaredEuclidean => Squared.between(a, b),
            Cost::Euclidean => Length.between(a, b),
        }
    }
}

/// Steps of a strip whose columns are stored together.
const BLOCK: usize = 32;

/// The columns component by component and in decreasing order, so that those of the lanes of a strip are adjacent. The
/// columns of [`BLOCK`] steps have a block of their own, whose fixed length spares a check of bounds per component.
pub(crate) struct Slanted<const D: usize>(Vec<[[f64; BLOCK + STRIP - 1]; D]>);

impl<const D: usize> Slanted<D> {
    /// The steps of the columns; beyond the ends the first or the last step is repeated. Cells there are computed but
    /// not used, and do not overflow unless a cell of the grid does.
    #[inline(always)]
    pub(crate) fn of<T: Scalar>(columns: &[[T; D]]) -> Self {
        let last = columns.len() - 1;
        let mut blocks = vec![[[0.0; BLOCK + STRIP - 1]; D]; (last + STRIP - 1) / BLOCK + 1];
        for (b, block) in blocks.iter_mut().enumerate() {
            for (k, numbers) in block.iter_mut().enumerate() {
                for (i, number) in numbers.iter_mut().enumerate() {
                    let column = ((b + 1) * BLOCK - 1).saturating_sub(i).min(last);
                    *number = columns[column][k].widened();
                }
            }
        }
        Self(blocks)
    }

    /// The values for the lanes in step `d` of a strip, component by component: lane l is at column d − l.
    #[inline(always)]
    pub(crate) fn window(&self, d: usize) -> [&Lanes; D] {
        let from = BLOCK - 1 - d % BLOCK;
        let block = &self.0[d / BLOCK];
        let mut window = [&[0.0; STRIP]; D];
        for k in 0..D {
            window[k] = block[k][from..from + STRIP].first_chunk().expect("of this length");
        }
        window
    }
}
