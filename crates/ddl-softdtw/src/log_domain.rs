//! The textbook recursion in the log domain. It is used for γ = 0 and for extreme ratios of cost to γ, and is the
//! reference for tests of the fast recursion.

use crate::grid::{Grid, cost};
use crate::softmin::{softmin, softmin_weights};

/// Weights of the three ways into a cell: from (i−1, j−1), (i−1, j) and (i, j−1).
type Ways = [f64; 3];

impl<const D: usize> Grid<'_, D> {
    /// The value; infinite when it exceeds the range of `f64`.
    pub(crate) fn log_domain_value(&self) -> f64 {
        if self.gamma > 0.0 { self.last_cell(|a, b, c| softmin(a, b, c, self.gamma)) } else { self.last_cell(minimum) }
    }

    /// The value and its gradient with respect to the rows; the gradient holds NaN or infinity if it exceeds the range
    /// of `f64`.
    pub(crate) fn log_domain_gradient(&self) -> (f64, Vec<[f64; D]>) {
        let mut ways: Vec<Ways> = Vec::with_capacity(self.rows.len() * self.columns.len());
        let value = self.last_cell(|diagonal, up, left| {
            let (smallest, weights) = softmin_weights([diagonal, up, left], self.gamma);
            ways.push(weights);
            smallest
        });
        (value, self.expected_slopes(&ways))
    }

    /// The recursion over all cells, row by row. `smallest` receives the values of the three predecessors of each cell.
    fn last_cell(&self, mut smallest: impl FnMut(f64, f64, f64) -> f64) -> f64 {
        // One row is kept: before cell (i, j) is written, row[j] still holds r(i−1, j).
        let mut row = vec![f64::INFINITY; self.columns.len()];
        let mut corner = 0.0;
        for x in self.rows {
            let (mut diagonal, mut left) = (corner, f64::INFINITY);
            for (cell, y) in row.iter_mut().zip(self.columns) {
                let up = *cell;
                left = cost(x, y) + smallest(diagonal, up, left);
                *cell = left;
                diagonal = up;
            }
            corner = f64::INFINITY;
        }
        row.last().copied().unwrap_or(f64::INFINITY)
    }

    /// `Σ_j E(i, j) ∂δ(x_i, y_j)/∂x_i` for every row i, from the last one up.
    fn expected_slopes(&self, ways: &[Ways]) -> Vec<[f64; D]> {
        let width = self.columns.len();
        let mut slopes = vec![[0.0; D]; self.rows.len()];
        // Entry j + 1 is the contribution of the row below to column j; entry 0 receives contributions to the left of
        // column 0.
        let mut below = vec![0.0; width + 1];
        below[width] = 1.0;
        for (i, x) in self.rows.iter().enumerate().rev() {
            let (mut from_right, mut to_diagonal) = (0.0, 0.0);
            for (j, y) in self.columns.iter().enumerate().rev() {
                let [diagonal, up, left] = ways[i * width + j];
                let expected = below[j + 1] + from_right;
                if expected > 0.0 {
                    for k in 0..D {
                        slopes[i][k] += expected * (2.0 * (x[k] - y[k]));
                    }
                }
                // Column j of the row above receives the diagonal contribution of (i, j + 1) and the upward
                // contribution of (i, j).
                below[j + 1] = to_diagonal + expected * up;
                to_diagonal = expected * diagonal;
                from_right = expected * left;
            }
            below[0] = to_diagonal;
        }
        slopes
    }
}

fn minimum(a: f64, b: f64, c: f64) -> f64 {
    let ab = if b < a { b } else { a };
    if c < ab { c } else { ab }
}
