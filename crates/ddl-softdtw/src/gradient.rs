//! The gradient of soft-DTW: the expected alignment of each cell times the derivative of its cost.

use crate::error::{SequenceRole, SoftDtwError};
use crate::log_domain::Gradients;
use crate::scalar::Scalar;
use crate::value::{SoftDtw, check, finite, normalise, rounded};

impl SoftDtw {
    /// `D_γ(x, y)` and its gradient with respect to `x`.
    ///
    /// The gradient is `Σ_j E(i, j) ∂δ(x_i, y_j)/∂x_i`, where E(i, j), the expected alignment, is the probability that
    /// a warping path drawn with weight exp(−cost/γ) passes cell (i, j).
    ///
    /// # Shapes
    /// `x`: n steps, `y`: m steps; the gradient has the shape of `x`. Memory: O(n m), with a band O(n · its width).
    ///
    /// # Errors
    /// As [`SoftDtw::value`]; also [`SoftDtwError::Overflow`] when a component of the gradient leaves the range of `T`.
    ///
    /// # Numerics
    /// All terms are positive, so nothing cancels. With the bound b on the error of the value ([`SoftDtw`]), E(i, j)
    /// has a relative error of at most 3 b / γ, if that is small. The value is that of [`SoftDtw::value`] to the last
    /// bit. γ = 0 gives the gradient along one best path (a subgradient). The Euclidean cost contributes 0 if
    /// `x_i = y_j`.
    ///
    /// # References
    /// Cuturi & Blondel (2017), algorithm 2.
    pub fn value_and_gradient<T: Scalar, const D: usize>(
        &self,
        x: &[[T; D]],
        y: &[[T; D]],
    ) -> Result<(T, Vec<[T; D]>), SoftDtwError> {
        check(x, SequenceRole::X)?;
        check(y, SequenceRole::Y)?;
        let (value, of_x, _) = self.gradients_unchecked(x, y);
        Ok((rounded(value)?, narrowed(&of_x)?))
    }

    /// `D_γ(x, y)` with its gradients with respect to `x` and to `y`, at the cost of one gradient.
    ///
    /// # Shapes
    /// The gradients have the shapes of `x` and of `y`.
    ///
    /// # Errors
    /// As [`SoftDtw::value_and_gradient`].
    #[expect(clippy::type_complexity, reason = "a value and two gradients")]
    pub fn value_and_gradients<T: Scalar, const D: usize>(
        &self,
        x: &[[T; D]],
        y: &[[T; D]],
    ) -> Result<(T, Vec<[T; D]>, Vec<[T; D]>), SoftDtwError> {
        check(x, SequenceRole::X)?;
        check(y, SequenceRole::Y)?;
        let (value, of_x, of_y) = self.gradients_unchecked(x, y);
        Ok((rounded(value)?, narrowed(&of_x)?, narrowed(&of_y)?))
    }

    /// The normalised value and its gradient with respect to `x` (see [`SoftDtw::normalised`]).
    ///
    /// D(x, x) depends on `x` through both arguments, so half of it contributes the gradient of the first argument
    /// once.
    ///
    /// # Errors
    /// As [`SoftDtw::value_and_gradient`].
    pub fn normalised_and_gradient<T: Scalar, const D: usize>(
        &self,
        x: &[[T; D]],
        y: &[[T; D]],
    ) -> Result<(T, Vec<[T; D]>), SoftDtwError> {
        check(x, SequenceRole::X)?;
        check(y, SequenceRole::Y)?;
        let (value, mut gradient, _) = self.gradients_unchecked(x, y);
        let value = finite(value)?;
        if self.gamma() == 0.0 {
            // D(x, x) is 0 for every x.
            return Ok((rounded(value)?, narrowed(&gradient)?));
        }
        let (self_x, own, _) = self.gradients_unchecked(x, x);
        let value = normalise(value, self_x, self.self_value(y));
        for (component, own) in gradient.as_flattened_mut().iter_mut().zip(own.as_flattened()) {
            *component -= own;
        }
        Ok((rounded(value)?, narrowed(&gradient)?))
    }

    /// The value and both gradients of checked sequences; not finite if they exceed the range of `f64`.
    fn gradients_unchecked<T: Scalar, const D: usize>(&self, x: &[[T; D]], y: &[[T; D]]) -> Gradients<D> {
        let grid = self.grid(x, y);
        let gradients = grid.gradients().unwrap_or_else(|| grid.log_domain_gradients());
        let (value, of_rows, of_columns) = gradients;
        if x.len() < y.len() {
            (value, of_columns, of_rows)
        } else {
            (value, of_rows, of_columns)
        }
    }

    /// [`SoftDtw::value_and_gradient`] by the textbook recursion in the log domain: slow, the reference for tests.
    #[doc(hidden)]
    pub fn log_domain_gradient<T: Scalar, const D: usize>(
        &self,
        x: &[[T; D]],
        y: &[[T; D]],
    ) -> Result<(f64, Vec<[f64; D]>), SoftDtwError> {
        check(x, SequenceRole::X)?;
        check(y, SequenceRole::Y)?;
        let (value, of_rows, of_columns) = self.grid(x, y).log_domain_gradients();
        let gradient = if x.len() < y.len() { of_columns } else { of_rows };
        Ok((finite(value)?, narrowed(&gradient)?))
    }
}

fn narrowed<T: Scalar, const D: usize>(gradient: &[[f64; D]]) -> Result<Vec<[T; D]>, SoftDtwError> {
    let narrow = gradient.iter().map(|step| step.map(T::rounded));
    let narrow: Vec<[T; D]> = narrow.collect();
    if narrow
        .as_flattened()
        .iter()
        .all(|component| component.widened().is_finite())
    {
        Ok(narrow)
    } else {
        Err(SoftDtwError::Overflow)
    }
}
