//! The backward recursion: the expected alignment of two sequences, and the gradients it gives.
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

use crate::cost::{Cost, Length, Metric, Squared};
use crate::exp2::{Lanes, STRIP};
use crate::grid::{Grid, Strip};
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

    fn restart(&mut self) {
        self.steps.clear();
    }
}

/// What a strip sends up to the strip above, and what the sequences have gathered so far.
struct Gathered<const D: usize> {
    /// Entry c + 3 is what arrives at column c of the strip above.
    arriving: Vec<f64>,
    of_rows: Vec<[f64; D]>,
    of_columns: Vec<[f64; D]>,
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
        let mut shares = Shares {
            steps: Vec::with_capacity(self.steps()),
        };
        let value = self.value(&mut shares)?;
        let mut gathered = Gathered {
            arriving: vec![0.0; self.columns.len() + 2 * (STRIP - 1)],
            of_rows: vec![[0.0; D]; self.rows.len()],
            of_columns: vec![[0.0; D]; self.columns.len()],
        };
        // Every path ends in the last cell: as if it came from the last column below.
        gathered.arriving[self.columns.len() + STRIP - 2] = 1.0;
        let mut steps = shares.steps.as_slice();
        for index in (0..self.strips()).rev() {
            let strip = self.strip(index);
            let (rest, own) = steps.split_at(steps.len() - (strip.end + 1 - strip.start));
            steps = rest;
            let of_lanes = match self.cost {
                Cost::SquaredEuclidean => self.retreat(Squared, &strip, own, &mut gathered),
                Cost::Euclidean => self.retreat(Length, &strip, own, &mut gathered),
            };
            let spare = self.strips() * STRIP - self.rows.len();
            for (lane, of_lane) in of_lanes.into_iter().enumerate() {
                // Lanes above the first row belong to no row.
                if let Some(row) = (index * STRIP + lane).checked_sub(spare) {
                    gathered.of_rows[row] = of_lane;
                }
            }
        }
        Some((value, gathered.of_rows, gathered.of_columns))
    }

    fn steps(&self) -> usize {
        let steps = |index| {
            let strip = self.strip(index);
            strip.end + 1 - strip.start
        };
        (0..self.strips()).map(steps).sum()
    }

    #[inline(always)]
    fn retreat<M: Metric>(
        &self,
        metric: M,
        strip: &Strip<D>,
        shares: &[[Lanes; 3]],
        gathered: &mut Gathered<D>,
    ) -> [[f64; D]; STRIP] {
        let (start, end) = (strip.start, strip.end);
        let arriving = &mut gathered.arriving[..end + STRIP];
        let mut of_rows = [[0.0; D]; STRIP];
        let mut y = self.window(end);
        // What the step before (the next column) sent left, and up and along the diagonal to the lane above.
        let mut left = [0.0; STRIP];
        let mut above = [0.0; STRIP];
        let mut diagonal = [0.0; STRIP];
        for (offset, [to_diagonal, to_up, to_left]) in shares.iter().enumerate().rev() {
            let d = start + offset;
            if d < end {
                y = [y[1], y[2], y[3], self.column(d, STRIP - 1)];
            }
            let from_below = [above[1], above[2], above[3], arriving[d]];
            arriving[d] = 0.0;
            let mut expected = [0.0; STRIP];
            for l in 0..STRIP {
                expected[l] = left[l] + from_below[l];
                left[l] = expected[l] * to_left[l];
                let up = expected[l] * to_up[l];
                above[l] = up + diagonal[l];
                diagonal[l] = expected[l] * to_diagonal[l];
            }
            for l in 0..STRIP {
                let slope = metric.slope(&strip.x[l], &y[l]);
                let mut part = [0.0; D];
                for k in 0..D {
                    part[k] = expected[l] * slope[k];
                    of_rows[l][k] += part[k];
                }
                // Beyond the first and the last column nothing is expected.
                let column = gathered.of_columns.get_mut(d.wrapping_sub(l));
                if let Some(of_column) = column {
                    for k in 0..D {
                        of_column[k] -= part[k];
                    }
                }
            }
            // Lane 0 sends to the strip above: up to its own column, where the diagonal of the next column arrives too.
            arriving[d + STRIP - 1] += above[0];
        }
        // What lane 0 of the first step sends along its diagonal.
        arriving[start + STRIP - 2] += diagonal[0];
        of_rows
    }
}
