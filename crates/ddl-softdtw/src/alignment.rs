//! The backward recursion: the expected alignment of two sequences, and the gradients it gives.
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

use ddl_simd::{Dispatch, Register, RegisterKernel};

use crate::cost::{Cost, Length, Metric, Squared};
use crate::exp2::{Lanes, STRIP, above};
use crate::grid::{Grid, Slanted, Strip};
use crate::log_domain::Gradients;
use crate::scalar::Scalar;
use crate::wavefront::StepRecord;

/// For each step of each strip, in order, the shares that the three ways into its cells have in them.
struct Shares {
    steps: Vec<[Lanes; 3]>,
}

impl StepRecord for Shares {
    #[inline(always)]
    fn step(&mut self, addends: &[Lanes; 3], sums: &Lanes) {
        let mut shares = *addends;
        for l in 0..STRIP {
            // A plain number is 0 where no path comes.
            let scale = if sums[l] > 0.0 { 1.0 / sums[l] } else { 0.0 };
            for share in &mut shares {
                share[l] *= scale;
            }
        }
        self.steps.push(shares);
    }
}

/// What a strip sends up to the strip above, and what the sequences have gathered so far.
struct Gathered<const D: usize> {
    /// Entry c + 7 is what arrives at column c of the strip above.
    arriving: Vec<f64>,
    of_rows: Vec<[f64; D]>,
    of_columns: Slanted,
}

/// Compiled for each instruction set, as the value is.
struct Backwards<'a, 'b, T, const D: usize>(&'a Grid<'b, T, D>);

impl<T: Scalar, const D: usize> RegisterKernel for Backwards<'_, '_, T, D> {
    type Output = Option<Gradients<D>>;

    #[inline(always)]
    fn run<S: Register>(self, simd: S) -> Option<Gradients<D>> {
        self.0.gradients_here(simd)
    }
}

impl<T: Scalar, const D: usize> Grid<'_, T, D> {
    /// The value and its gradients, or `None` where the log domain must be used (as [`Grid::value`]).
    ///
    /// ```text
    /// E(i, j) = E(i+1, j+1) d(i+1, j+1) + E(i+1, j) u(i+1, j) + E(i, j+1) l(i, j+1)
    /// ```
    ///
    /// with the shares d, u, l of the diagonal, the upper and the left way into a cell, strip by strip backwards.
    pub(crate) fn gradients(&self) -> Option<Gradients<D>> {
        Dispatch::detect().run_on_registers(Backwards(self))
    }

    #[inline(always)]
    fn gradients_here<S: Register>(&self, simd: S) -> Option<Gradients<D>> {
        let mut shares = Shares {
            steps: Vec::with_capacity(self.steps()),
        };
        let columns = Slanted::of(self.columns);
        let value = self.value_here(&columns, &mut shares)?;
        let mut gathered = Gathered {
            arriving: vec![0.0; self.columns.len() + 2 * (STRIP - 1)],
            of_rows: vec![[0.0; D]; self.rows.len()],
            of_columns: Slanted::zeros::<D>(self.columns.len()),
        };
        // Every path ends in the last cell: as if it came from the last column below.
        gathered.arriving[self.columns.len() + STRIP - 2] = 1.0;
        let mut steps = shares.steps.as_slice();
        for index in (0..self.strips()).rev() {
            let strip = self.strip(index);
            let (rest, own) = steps.split_at(steps.len() - (strip.end + 1 - strip.start));
            steps = rest;
            let of_lanes = match self.cost {
                Cost::SquaredEuclidean => {
                    retreat(simd, Squared, &strip, own, &columns, &mut gathered)
                }
                Cost::Euclidean => retreat(simd, Length, &strip, own, &columns, &mut gathered),
            };
            let spare = self.strips() * STRIP - self.rows.len();
            for lane in 0..STRIP {
                // Lanes above the first row belong to no row.
                if let Some(row) = (index * STRIP + lane).checked_sub(spare) {
                    gathered.of_rows[row] = of_lanes.map(|component| component[lane]);
                }
            }
        }
        Some((value, gathered.of_rows, gathered.of_columns.columns()))
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
fn retreat<S: Register, M: Metric, const D: usize>(
    simd: S,
    metric: M,
    strip: &Strip<D>,
    shares: &[[Lanes; 3]],
    columns: &Slanted,
    gathered: &mut Gathered<D>,
) -> [Lanes; D] {
    let (start, end) = (strip.start, strip.end);
    let arriving = &mut gathered.arriving[..end + STRIP];
    let mut of_rows = [[0.0; STRIP]; D];
    // What the step before (the next column) sent left, and up and along the diagonal to the lane above.
    let mut left = [0.0; STRIP];
    let mut upwards = [0.0; STRIP];
    let mut diagonal = [0.0; STRIP];
    for (offset, [to_diagonal, to_up, to_left]) in shares.iter().enumerate().rev() {
        let d = start + offset;
        let from_below = above(&upwards, arriving[d]);
        arriving[d] = 0.0;
        let mut expected = [0.0; STRIP];
        for l in 0..STRIP {
            expected[l] = left[l] + from_below[l];
            left[l] = expected[l] * to_left[l];
            let up = expected[l] * to_up[l];
            upwards[l] = up + diagonal[l];
            diagonal[l] = expected[l] * to_diagonal[l];
        }
        let slopes = metric.slopes(&strip.x, &columns.window(d));
        // Beyond the first and the last column nothing is expected.
        let of_columns = gathered.of_columns.window_mut::<D>(d);
        for ((slope, of_row), of_column) in slopes.iter().zip(&mut of_rows).zip(of_columns) {
            for part in 0..S::PARTS {
                let expected = simd.wide_load(&expected, part);
                let gradient = simd.wide_mul(expected, simd.wide_load(slope, part));
                let total = simd.wide_add(simd.wide_load(of_row, part), gradient);
                simd.wide_store(total, of_row, part);
                let total = simd.wide_sub(simd.wide_load(of_column, part), gradient);
                simd.wide_store(total, of_column, part);
            }
        }
        // Lane 0 sends to the strip above: up to its own column, where the diagonal of the next column arrives too.
        arriving[d + STRIP - 1] += upwards[0];
    }
    // What lane 0 of the first step sends along its diagonal.
    arriving[start + STRIP - 2] += diagonal[0];
    of_rows
}
