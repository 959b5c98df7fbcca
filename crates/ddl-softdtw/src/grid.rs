//! The grid of all pairs of steps, cut into strips of eight rows.
#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use ddl_simd::Simd;
use fearless_simd::f64x8;
use fearless_simd::prelude::*;

/// Number of cells computed together: neighbours on an antidiagonal, one per row.
pub(crate) const STRIP: usize = 8;
/// One number per row of a strip.
pub(crate) type StripLanes = [f64; STRIP];

/// Exponents are exact integers while the whole parts of all t along a path sum to no more than this.
const EXACT: f64 = 4_503_599_627_370_496.0; // 2^52

/// Two checked sequences and the parameters of their soft-DTW: row i is step i of one, column j step j of the other.
pub(crate) struct Grid<'a, const D: usize> {
    pub(crate) rows: &'a [[f64; D]],
    pub(crate) columns: &'a [[f64; D]],
    pub(crate) gamma: f64,
}

/// Consecutive rows that advance together, one per lane, each one column behind the row above it. In step d of the
/// strip, lane l is at column d − l.
pub(crate) struct Strip<const D: usize> {
    /// The rows' steps, component by component. Lanes above the first row repeat it.
    pub(crate) x: [StripLanes; D],
    /// First and last step in which some lane is at a column of the grid.
    pub(crate) start: usize,
    pub(crate) end: usize,
    /// The lane of row 0, in the strip that holds it: every path starts there, in step `start`.
    pub(crate) corner: Option<usize>,
}

impl<const D: usize> Grid<'_, D> {
    pub(crate) fn strips(&self) -> usize {
        self.rows.len().div_ceil(STRIP)
    }

    /// Lanes of the first strip above the first row, so that the last row is always in the last lane.
    pub(crate) fn spare_lanes(&self) -> usize {
        self.strips() * STRIP - self.rows.len()
    }

    /// Strip `index`.
    #[inline(always)]
    pub(crate) fn strip(&self, index: usize) -> Strip<D> {
        let spare = self.spare_lanes();
        let mut x = [[0.0; STRIP]; D];
        for lane in 0..STRIP {
            let step = &self.rows[(index * STRIP + lane).saturating_sub(spare)];
            for (component, x) in x.iter_mut().zip(step) {
                component[lane] = *x;
            }
        }
        Strip {
            x,
            start: if index == 0 { spare } else { 0 },
            end: self.columns.len() - 1 + STRIP - 1,
            corner: (index == 0).then_some(spare),
        }
    }

    /// The costs of the lanes of a strip, with fused products.
    #[inline(always)]
    pub(crate) fn costs<S: Simd>(simd: S, differences: [f64x8<S>; D]) -> f64x8<S> {
        // Even and odd components are summed separately, which halves the latency of a single chain.
        let mut halves = [f64x8::splat(simd, 0.0); 2];
        for k in 0..D {
            let difference = differences[k];
            halves[k % 2] =
                if k < 2 { difference * difference } else { difference.mul_add_precise(difference, halves[k % 2]) };
        }
        if D > 1 { halves[0] + halves[1] } else { halves[0] }
    }

    /// The factor from a cost to t: log2(e) / γ.
    pub(crate) fn scale(&self) -> f64 {
        std::f64::consts::LOG2_E / self.gamma
    }

    /// Whether all exponents are exact integers. Otherwise, and for γ = 0, the recursion runs in the log domain.
    pub(crate) fn is_exact(&self) -> bool {
        let (n, m) = (self.rows.len(), self.columns.len());
        self.cost_bound() * self.scale() * (n + m) as f64 <= EXACT
    }

    /// A bound of the cost of two steps: that of opposite corners of the box around all steps.
    fn cost_bound(&self) -> f64 {
        let mut low = self.rows[0];
        let mut high = low;
        for step in self.rows.iter().chain(self.columns) {
            for k in 0..D {
                low[k] = if step[k] < low[k] { step[k] } else { low[k] };
                high[k] = if step[k] > high[k] { step[k] } else { high[k] };
            }
        }
        cost(&low, &high)
    }
}

/// Cost of matching step `a` with step `b`: |a − b|², infinite when it exceeds the range of `f64`.
pub(crate) fn cost<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
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
    pub(crate) fn of(columns: &[[f64; D]]) -> Self {
        let last = columns.len() - 1;
        let mut blocks = vec![[[0.0; BLOCK + STRIP - 1]; D]; (last + STRIP - 1) / BLOCK + 1];
        for (b, block) in blocks.iter_mut().enumerate() {
            for (k, numbers) in block.iter_mut().enumerate() {
                for (i, number) in numbers.iter_mut().enumerate() {
                    *number = columns[((b + 1) * BLOCK - 1).saturating_sub(i).min(last)][k];
                }
            }
        }
        Self(blocks)
    }

    /// The differences between the rows of a strip and the columns of its lanes in step `d`: lane l is at column d − l.
    #[inline(always)]
    pub(crate) fn differences<S: Simd>(&self, simd: S, x: &[StripLanes; D], d: usize) -> [f64x8<S>; D] {
        let from = BLOCK - 1 - d % BLOCK;
        let block = &self.0[d / BLOCK];
        let mut differences = [f64x8::splat(simd, 0.0); D];
        for k in 0..D {
            let y: &StripLanes = block[k][from..from + STRIP].first_chunk().expect("of this length");
            differences[k] = f64x8::load_array_ref(simd, &x[k]) - f64x8::load_array_ref(simd, y);
        }
        differences
    }
}
