//! The gradient of soft-DTW: how much each cell of the alignment counts, times the slope of its cost.

use crate::error::{SequenceRole, SoftDtwError};
use crate::softmin::softmin_weights;
use crate::value::{SoftDtw, check, finite};

/// Weights of the three ways into a cell: from (i−1, j−1), (i−1, j) and (i, j−1).
type Ways = [f64; 3];

impl SoftDtw {
    /// `D_γ(x, y)` and its gradient with respect to `x`.
    ///
    /// The gradient is `Σ_j E(i, j) ∂δ(x_i, y_j)/∂x_i`, where E(i, j), the expected alignment, is the probability that a
    /// warping path drawn with weight exp(−cost/γ) passes cell (i, j).
    ///
    /// # Shapes
    /// `x`: n steps, `y`: m steps; the gradient has the shape of `x`. Memory: O(n m).
    ///
    /// # Errors
    /// As [`SoftDtw::value`]; also [`SoftDtwError::Overflow`] when a component of the gradient leaves the range of `f64`.
    ///
    /// # Numerics
    /// The weights of each smoothed minimum are kept from the forward recursion, where they are formed from differences;
    /// the backward recursion only multiplies and adds them, so it neither overflows nor loses digits at small γ.
    /// γ = 0 gives the gradient along one best path (a subgradient), and the Euclidean cost counts 0 where `x_i = y_j`.
    ///
    /// # References
    /// Cuturi & Blondel (2017), algorithm 2.
    ///
    /// # Examples
    /// ```
    /// use ddl_softdtw::{Cost, SoftDtw};
    /// let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean)?;
    /// // One step against one step: the gradient of (x − y)².
    /// let (value, gradient) = dtw.value_and_gradient(&[[3.0]], &[[1.0]])?;
    /// assert_eq!((value, gradient), (4.0, vec![[4.0]]));
    /// # Ok::<(), ddl_softdtw::SoftDtwError>(())
    /// ```
    pub fn value_and_gradient<const D: usize>(
        &self,
        x: &[[f64; D]],
        y: &[[f64; D]],
    ) -> Result<(f64, Vec<[f64; D]>), SoftDtwError> {
        check(x, SequenceRole::X)?;
        check(y, SequenceRole::Y)?;
        let (value, ways) = self.forward(x, y);
        let value = finite(value)?;
        let gradient = self.backward(x, y, &ways);
        if gradient
            .as_flattened()
            .iter()
            .all(|component| component.is_finite())
        {
            Ok((value, gradient))
        } else {
            Err(SoftDtwError::Overflow)
        }
    }

    /// The normalised value and its gradient with respect to `x` (see [`SoftDtw::normalised`]).
    ///
    /// D(x, x) depends on `x` through both of its arguments, which by symmetry contribute equally: its half enters with
    /// the gradient of the first argument once.
    ///
    /// # Errors
    /// As [`SoftDtw::value_and_gradient`].
    pub fn normalised_and_gradient<const D: usize>(
        &self,
        x: &[[f64; D]],
        y: &[[f64; D]],
    ) -> Result<(f64, Vec<[f64; D]>), SoftDtwError> {
        let value = self.normalised(x, y)?;
        let (_, mut gradient) = self.value_and_gradient(x, y)?;
        let (_, own) = self.value_and_gradient(x, x)?;
        for (component, own) in gradient
            .as_flattened_mut()
            .iter_mut()
            .zip(own.as_flattened())
        {
            *component -= own;
        }
        Ok((value, gradient))
    }

    /// The value, and for each cell (row by row) the weights of the ways into it.
    fn forward<const D: usize>(&self, x: &[[f64; D]], y: &[[f64; D]]) -> (f64, Vec<Ways>) {
        let mut ways = Vec::with_capacity(x.len() * y.len());
        let mut row = vec![f64::INFINITY; y.len()];
        let mut corner = 0.0;
        for step in x {
            let mut diagonal = corner;
            let mut left = f64::INFINITY;
            for (cell, other) in row.iter_mut().zip(y) {
                let up = *cell;
                let (smallest, weights) = softmin_weights([diagonal, up, left], self.gamma());
                ways.push(weights);
                left = self.cost().between(step, other) + smallest;
                *cell = left;
                diagonal = up;
            }
            corner = f64::INFINITY;
        }
        (row.last().copied().unwrap_or(f64::INFINITY), ways)
    }

    /// `Σ_j E(i, j) ∂δ(x_i, y_j)/∂x_i` for every i, from the last row up.
    fn backward<const D: usize>(
        &self,
        x: &[[f64; D]],
        y: &[[f64; D]],
        ways: &[Ways],
    ) -> Vec<[f64; D]> {
        let columns = y.len();
        let mut gradient = vec![[0.0; D]; x.len()];
        // arriving[j]: what the cells already visited send to cell (i, j); one more entry catches column −1.
        let mut arriving = vec![0.0; columns + 1];
        arriving[columns] = 1.0;
        for (i, row) in ways.chunks_exact(columns).enumerate().rev() {
            let mut next = vec![0.0; columns + 1];
            for (j, &[diagonal, up, left]) in row.iter().enumerate().rev() {
                // Column j of the matrix is entry j + 1, so that what leaves to the left of column 0 has a place.
                let expected = arriving[j + 1];
                self.cost()
                    .add_gradient(&x[i], &y[j], expected, &mut gradient[i]);
                next[j] += expected * diagonal;
                next[j + 1] += expected * up;
                arriving[j] += expected * left;
            }
            arriving = next;
        }
        gradient
    }
}
