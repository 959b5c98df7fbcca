//! The backward recursion: the expected alignment of two sequences, and the gradients from it.
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

use ddl_simd::{Dispatch, Register, RegisterKernel};

use crate::cost::{Cost, Length, Metric, Squared};
use crate::grid::{Grid, Slanted, Strip};
use crate::lanes::{Lanes, STRIP};
use crate::log_domain::Gradients;
use crate::scalar::Scalar;
use crate::wavefront::{STRETCH, StepRecord};
use crate::weight::{Plain, Scaled, TOTAL, Weight};

/// For each step of each strip, in order, 2^−t and R of its cells.
struct Steps<W: Weight>(Vec<(W::Factor, W)>);

impl<W: Weight> StepRecord<W> for Steps<W> {
    type Step = (W::Factor, W);

    #[inline(always)]
    fn strip(&mut self, steps: usize) -> &mut [(W::Factor, W)] {
        let before = self.0.len();
        self.0.resize(before + steps, (W::NONE_FACTOR, W::NONE));
        &mut self.0[before..]
    }

    #[inline(always)]
    fn step(factor: &W::Factor, cells: &W) -> (W::Factor, W) {
        (*factor, *cells)
    }
}

/// Results of a strip that the strip above it needs. Entry c + 7 is column c.
struct Below<W: Weight, const D: usize> {
    /// 2^−t S of the row below.
    row: Vec<W::One>,
    /// The contributions of the rows below to the gradients of the columns.
    of_columns: Vec<[f64; D]>,
}

/// Compiled for each instruction set, like the value.
pub(crate) struct Backwards<'a, 'b, T, const D: usize>(pub(crate) &'a Grid<'b, T, D>);

impl<T: Scalar, const D: usize> RegisterKernel for Backwards<'_, '_, T, D> {
    type Output = Option<Gradients<D>>;

    #[inline(always)]
    fn run<S: Register>(self, simd: S) -> Option<Gradients<D>> {
        match self.0.plain_start() {
            Some(start) => self.0.gradients_here::<S, Plain>(simd, start),
            None => self.0.gradients_here::<S, Scaled<Lanes>>(simd, 0.0),
        }
    }
}

impl<T: Scalar, const D: usize> Grid<'_, T, D> {
    /// The value and its gradients, or `None` if the log domain must be used (as [`Grid::value`]).
    ///
    /// With S(i, j), the sum of exp(−cost/γ) over the paths from cell (i, j) to the last one, without its own cost,
    ///
    /// ```text
    /// S(i, j) = 2^−t(i+1, j+1) S(i+1, j+1) + 2^−t(i+1, j) S(i+1, j) + 2^−t(i, j+1) S(i, j+1)
    /// ```
    ///
    /// the expected alignment is E(i, j) = R(i, j) S(i, j) / R(n, m). S is computed strip by strip backwards.
    pub(crate) fn gradients(&self) -> Option<Gradients<D>> {
        Dispatch::detect().run_on_registers(Backwards(self))
    }

    #[inline(always)]
    fn gradients_here<S: Register, W: Weight>(&self, simd: S, start: f64) -> Option<Gradients<D>> {
        let mut steps = Steps(Vec::with_capacity(self.steps()));
        let columns = Slanted::of(self.columns);
        let total = self.run::<S, W>(simd, start, &columns, &mut steps)?;
        // S starts from a power of two. Its product with R(n, m) has the exponent that shares are computed with.
        let (significand, exponent) = total;
        let seed = TOTAL - (start + exponent);
        let length = self.columns.len() + 2 * (STRIP - 1);
        let mut below = Below::<W, D> {
            row: vec![W::NONE_ONE; length],
            of_columns: vec![[0.0; D]; length],
        };
        // Every path ends in the last cell, as if it continued along the diagonal.
        below.row[self.columns.len() + STRIP - 1] = W::power(seed);
        let mut of_rows = vec![[0.0; D]; self.rows.len()];
        let mut steps = steps.0.as_slice();
        let spare = self.strips() * STRIP - self.rows.len();
        for index in (0..self.strips()).rev() {
            let strip = self.strip(index);
            let (rest, own) = steps.split_at(steps.len() - (strip.end + 1 - strip.start));
            steps = rest;
            let of_lanes = match self.cost {
                Cost::SquaredEuclidean => {
                    retreat(simd, Squared, &strip, own, &columns, (significand, TOTAL), &mut below)
                }
                Cost::Euclidean => retreat(simd, Length, &strip, own, &columns, (significand, TOTAL), &mut below),
            };
            for lane in 0..STRIP {
                // Lanes above the first row do not belong to a row.
                if let Some(row) = (index * STRIP + lane).checked_sub(spare) {
                    of_rows[row] = of_lanes.map(|component| component[lane]);
                }
            }
            if index % (STRETCH / STRIP) == 0 {
                for cell in &mut below.row {
                    *cell = W::normalised_one(*cell);
                }
            }
        }
        below.of_columns.truncate(length - (STRIP - 1));
        let of_columns = below.of_columns.split_off(STRIP - 1);
        Some((self.value_of(total), of_rows, of_columns))
    }

    fn steps(&self) -> usize {
        let steps = |index| {
            let strip = self.strip(index);
            strip.end + 1 - strip.start
        };
        (0..self.strips()).map(steps).sum()
    }
}

/// One strip backwards: the gradient of each of its rows, component by component.
#[inline(always)]
fn retreat<S: Register, W: Weight, M: Metric, const D: usize>(
    simd: S,
    metric: M,
    strip: &Strip<D>,
    steps: &[(W::Factor, W)],
    columns: &Slanted<D>,
    total: (f64, f64),
    below: &mut Below<W, D>,
) -> [Lanes; D] {
    let (start, end) = (strip.start, strip.end);
    let row = &mut below.row[..end + STRIP];
    let of_columns = &mut below.of_columns[..end + STRIP];
    let mut of_rows = [[0.0; STRIP]; D];
    // Gradients of the columns at which the lanes are. A column passes through the lanes from the last to the first.
    let mut of_lanes = [[0.0; STRIP]; D];
    for lane in 1..STRIP {
        for (of_lanes, of_column) in of_lanes.iter_mut().zip(of_columns[end + STRIP - lane]) {
            of_lanes[lane] = of_column;
        }
    }
    let slope = simd.wide_splat(M::SLOPE);
    let mut cells = W::NONE;
    let mut diagonal = W::NONE.above(simd, row[end + 1]);
    for (offset, (factor, forward)) in steps.iter().enumerate().rev() {
        let d = start + offset;
        let down = cells.above(simd, row[d]);
        let (sum, reached) = W::cells(simd, [&diagonal, &down, &cells], factor);
        (cells, diagonal) = (reached, down);
        row[d + STRIP - 1] = cells.first();
        let expected = W::shares(simd, forward, &sum, total);
        // Beyond the first and the last column the expected alignment is 0.
        let slopes = metric.slopes(simd, &strip.x, columns.window(d));
        let arriving = of_columns[d];
        let leaving = &mut of_columns[d + STRIP - 1];
        for k in 0..D {
            of_lanes[k] = simd.wide_above(&of_lanes[k], arriving[k]);
            for part in 0..S::PARTS {
                let expected = simd.wide_mul(simd.wide_load(&expected, part), slope);
                let gradient = simd.wide_mul(expected, simd.wide_load(&slopes[k], part));
                let of_row = simd.wide_add(simd.wide_load(&of_rows[k], part), gradient);
                simd.wide_store(of_row, &mut of_rows[k], part);
                let of_lane = simd.wide_sub(simd.wide_load(&of_lanes[k], part), gradient);
                simd.wide_store(of_lane, &mut of_lanes[k], part);
            }
            leaving[k] = of_lanes[k][0];
        }
        if d % STRETCH == 0 {
            cells = cells.normalised();
        }
    }
    for lane in 1..STRIP {
        of_columns[start + STRIP - 1 - lane] = of_lanes.map(|component| component[lane]);
    }
    of_rows
}
