//! The grid of all pairs of steps, cut into strips of a few rows.
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

use std::ops::RangeInclusive;

use crate::band::Band;
use crate::cost::Cost;
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
    /// The rows' steps. Lanes above the first row repeat it.
    pub(crate) x: [[f64; D]; STRIP],
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
    pub(crate) fn strip(&self, index: usize) -> Strip<D> {
        let (n, m) = (self.rows.len(), self.columns.len());
        let spare = self.strips() * STRIP - n;
        let top = if index == 0 { spare } else { 0 };
        let row = |lane: usize| (index * STRIP + lane).saturating_sub(spare);
        let mut strip = Strip {
            x: [[0.0; D]; STRIP],
            start: top,
            end: m - 1 + STRIP - 1,
            first: [f64::INFINITY; STRIP],
            last: [0.0; STRIP],
            corner: (index == 0).then_some(spare),
        };
        for (lane, x) in strip.x.iter_mut().enumerate() {
            *x = widened(&self.rows[row(lane)]);
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

    /// The step of the column that `lane` is at in step `d` of a strip; beyond the ends the first or the last one.
    /// Cells beyond the ends are computed and not used: nothing in them overflows unless it does within the grid.
    #[inline(always)]
    pub(crate) fn column(&self, d: usize, lane: usize) -> [f64; D] {
        widened(&self.columns[d.saturating_sub(lane).min(self.columns.len() - 1)])
    }

    pub(crate) fn window(&self, d: usize) -> [[f64; D]; STRIP] {
        let mut window = [[0.0; D]; STRIP];
        for (lane, y) in window.iter_mut().enumerate() {
            *y = self.column(d, lane);
        }
        window
    }
}
