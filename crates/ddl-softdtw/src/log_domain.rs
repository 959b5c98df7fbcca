//! The textbook recursion in the log domain. It is used for γ = 0 and for extreme ratios of cost to γ, and is the
//! reference for tests of the fast recursion.

use crate::cost::{Cost, Length, Metric, Squared};
use crate::grid::Grid;
use crate::scalar::{Scalar, widened};
use crate::softmin::{softmin, softmin_weights};

/// Weights of the three ways into a cell: from (i−1, j−1), (i−1, j) and (i, j−1).
type Ways = [f64; 3];

/// Value, gradient with respect to the rows, gradient with respect to the columns.
pub(crate) type Gradients<const D: usize> = (f64, Vec<[f64; D]>, Vec<[f64; D]>);

impl<T: Scalar, const D: usize> Grid<'_, T, D> {
    /// The value; infinite when it exceeds the range of `f64`.
    pub(crate) fn log_domain_value(&self) -> f64 {
        match (self.cost, self.gamma > 0.0) {
            (Cost::SquaredEuclidean, true) => self.rows(Squared, |a, b, c| softmin(a, b, c, self.gamma)),
            (Cost::Euclidean, true) => self.rows(Length, |a, b, c| softmin(a, b, c, self.gamma)),
            (Cost::SquaredEuclidean, false) => self.rows(Squared, minimum),
            (Cost::Euclidean, false) => self.rows(Length, minimum),
        }
    }

    /// The value and its gradients; the gradients hold NaN or infinity if they exceed the range of `f64`.
    pub(crate) fn log_domain_gradients(&self) -> Gradients<D> {
        let mut ways = Vec::new();
        match self.cost {
            Cost::SquaredEuclidean => {
                let value = self.rows(Squared, |a, b, c| self.softmin(a, b, c, &mut ways));
                let (rows, columns) = self.back(Squared, &ways);
                (value, rows, columns)
            }
            Cost::Euclidean => {
                let value = self.rows(Length, |a, b, c| self.softmin(a, b, c, &mut ways));
                let (rows, columns) = self.back(Length, &ways);
                (value, rows, columns)
            }
        }
    }

    fn softmin(&self, diagonal: f64, up: f64, left: f64, ways: &mut Vec<Ways>) -> f64 {
        let (smallest, weights) = softmin_weights([diagonal, up, left], self.gamma);
        ways.push(weights);
        smallest
    }

    /// The recursion over all cells of the band, row by row. `smallest` receives the values of the three predecessors
    /// of each cell.
    fn rows(&self, metric: impl Metric, mut smallest: impl FnMut(f64, f64, f64) -> f64) -> f64 {
        // One row is kept: before cell (i, j) is written, row[j] still holds r(i−1, j).
        let mut row = vec![f64::INFINITY; self.columns.len()];
        for (i, x) in self.rows.iter().enumerate() {
            let x = widened(x);
            let range = self.band_columns(i);
            let first = *range.start();
            // r(i−1, first−1): outside the grid it is 0 above the first row and +inf below it.
            let mut diagonal = match (i, first) {
                (0, _) => 0.0,
                (_, 0) => f64::INFINITY,
                (_, first) => row[first - 1],
            };
            let mut left = f64::INFINITY;
            for (cell, y) in row[range.clone()].iter_mut().zip(&self.columns[range]) {
                let up = *cell;
                left = metric.between(&x, &widened(y)) + smallest(diagonal, up, left);
                *cell = left;
                diagonal = up;
            }
            if first > 0 {
                // This cell is not in the band of the row; it may still hold a value of the row above.
                row[first - 1] = f64::INFINITY;
            }
        }
        row.last().copied().unwrap_or(f64::INFINITY)
    }

    /// `Σ_j E(i, j) ∂δ(x_i, y_j)/∂x_i` for every i and the same for the columns, from the last row up.
    fn back(&self, metric: impl Metric, ways: &[Ways]) -> (Vec<[f64; D]>, Vec<[f64; D]>) {
        let mut of_rows = vec![[0.0; D]; self.rows.len()];
        let mut of_columns = vec![[0.0; D]; self.columns.len()];
        // Entry j + 1 is the contribution of the row below to column j; entry 0 receives contributions to the left of
        // column 0.
        let mut below = vec![0.0; self.columns.len() + 1];
        below[self.columns.len()] = 1.0;
        let mut end = ways.len();
        for (i, x) in self.rows.iter().enumerate().rev() {
            let range = self.band_columns(i);
            let (first, last) = (*range.start(), *range.end());
            let begin = end - (last + 1 - first);
            let mut from_right = 0.0;
            let mut to_diagonal = 0.0;
            for j in range.rev() {
                let [diagonal, up, left] = ways[begin + j - first];
                let expected = below[j + 1] + from_right;
                if expected > 0.0 {
                    let slope = metric.slope(&widened(x), &widened(&self.columns[j]));
                    for k in 0..D {
                        of_rows[i][k] += expected * slope[k];
                        of_columns[j][k] -= expected * slope[k];
                    }
                }
                // Column j of the row above receives the diagonal contribution of (i, j + 1) and the upward
                // contribution of (i, j).
                below[j + 1] = to_diagonal + expected * up;
                to_diagonal = expected * diagonal;
                from_right = expected * left;
            }
            below[first] = to_diagonal;
            end = begin;
        }
        (of_rows, of_columns)
    }
}

fn minimum(a: f64, b: f64, c: f64) -> f64 {
    let ab = if b < a { b } else { a };
    if c < ab { c } else { ab }
}
