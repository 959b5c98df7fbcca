//! The grid of all pairs of steps, cut into strips of a few rows.
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

use std::ops::RangeInclusive;

use crate::band::Band;
use crate::cost::{Cost, Length, Metric as _, Squared};
use crate::exp2::{Lanes, STRIP};
use crate::scalar::{Scalar, widened};

/// Two checked sequences and what is asked of them: row i is step i of one, column j step j of the other.
pub(crate) struct Grid<'a, T, const D: usize> {
    pub(crate) rows: &'a [[T; D]],
    pub(crate) columns: &'a [[T; D]],
    pub(crate) gamma: f64,
    pub(crate) cost: Cost,
    pub(crate) band: Option<Band>,
}

/// Consecutive rows that advance together, one a lane, each one column behind the row above it: in step d of the strip
/// lane l is at column d − l.
pub(crate) struct Strip<const D: usize> {
    /// The rows' steps, component by component. Lanes above the first row repeat it.
    pub(crate) x: [Lanes; D],
    /// First and last step in which some lane is at a column of the grid (and of the band).
    pub(crate) start: usize,
    pub(crate) end: usize,
    /// First and last step in which each lane is in the band; for a grid without one they hold nothing.
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

    /// The largest cost that two steps can have: that of the corners of the box around all of them.
    pub(crate) fn cost_bound(&self) -> f64 {
        let mut low = widened(&self.rows[0]);
        let mut high = low;
        for step in self.rows.iter().chain(self.columns) {
            let step = widened(step);
            for k in 0..D {
                low[k] = if step[k] < low[k] { step[k] } else { low[k] };
                high[k] = if step[k] > high[k] { step[k] } else { high[k] };
            }
        }
        match self.cost {
            Cost::SquaredEuclidean => Squared.between(&low, &high),
            Cost::Euclidean => Length.between(&low, &high),
        }
    }
}

/// A number for each component of each column, component by component and from the last column to the first, so that
/// what the lanes of
/// a strip are at lies side by side. Before the first and after the last column there is room for the slanted ends of a
/// strip.
pub(crate) struct Slanted {
    numbers: Vec<f64>,
    /// Numbers a component.
    stride: usize,
}

impl Slanted {
    /// The steps of the columns; beyond the ends the first or the last one. Cells there are computed and not used:
    /// nothing in them
    /// overflows unless it does within the grid.
    #[inline(always)]
    pub(crate) fn of<T: Scalar, const D: usize>(columns: &[[T; D]]) -> Self {
        let mut slanted = Self::zeros::<D>(columns.len());
        for k in 0..D {
            let numbers = &mut slanted.numbers[k * slanted.stride..][..slanted.stride];
            let (after, rest) = numbers.split_at_mut(STRIP - 1);
            let (within, before) = rest.split_at_mut(columns.len());
            after.fill(columns[columns.len() - 1][k].widened());
            before.fill(columns[0][k].widened());
            for (number, column) in within.iter_mut().rev().zip(columns) {
                *number = column[k].widened();
            }
        }
        slanted
    }

    pub(crate) fn zeros<const D: usize>(columns: usize) -> Self {
        let stride = columns + 2 * (STRIP - 1);
        let numbers = vec![0.0; D * stride];
        Self { numbers, stride }
    }

    /// What the lanes are at in step `d` of a strip: lane l at column d - l.
    #[inline(always)]
    pub(crate) fn window<const D: usize>(&self, d: usize) -> [Lanes; D] {
        let mut window = [[0.0; STRIP]; D];
        for (k, lanes) in window.iter_mut().enumerate() {
            let from = (k + 1) * self.stride - STRIP - d;
            lanes.copy_from_slice(&self.numbers[from..from + STRIP]);
        }
        window
    }

    /// The same, to be changed.
    #[inline(always)]
    pub(crate) fn window_mut<const D: usize>(
        &mut self,
        d: usize,
    ) -> impl Iterator<Item = &mut Lanes> {
        let from = self.stride - STRIP - d;
        let components = self.numbers.chunks_exact_mut(self.stride).take(D);
        components.filter_map(move |numbers| numbers[from..].first_chunk_mut())
    }

    /// The numbers, a step a column.
    pub(crate) fn columns<const D: usize>(&self) -> Vec<[f64; D]> {
        let first = self.stride - STRIP;
        let last = STRIP - 1;
        let column = |at: usize| std::array::from_fn(|k| self.numbers[k * self.stride + at]);
        (last..=first).rev().map(column).collect()
    }
}
