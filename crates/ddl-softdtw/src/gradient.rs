//! The gradient of soft-DTW: the expected alignment of each cell times the derivative of its cost.

use crate::error::SoftDtwError;
use crate::value::{SoftDtw, check, finite, normalise};

impl SoftDtw {
    /// `D_γ(x, y)` and its gradient with respect to `x`.
    ///
    /// The gradient is `Σ_j E(i, j) ∂δ(x_i, y_j)/∂x_i`, where E(i, j), the expected alignment, is the probability that
    /// a warping path drawn with weight exp(−cost/γ) passes cell (i, j).
    ///
    /// # Shapes
    /// `x`: n steps, `y`: m steps; the gradient has the shape of `x`. Memory: O(n m).
    ///
    /// # Errors
    /// As [`SoftDtw::value`]; also [`SoftDtwError::Overflow`] when a component of the gradient leaves the range of
    /// `f64`.
    ///
    /// # Numerics
    /// All terms are positive, so nothing cancels. With the bound b on the error of the value ([`SoftDtw`]), E(i, j)
    /// has a relative error of at most 3 b / γ, if that is small. The value is that of [`SoftDtw::value`] to the last
    /// bit. γ = 0 gives the gradient along one best path (a subgradient).
    ///
    /// # References
    /// Cuturi & Blondel (2017), algorithm 2.
    pub fn value_and_gradient<const D: usize>(
        &self,
        x: &[[f64; D]],
        y: &[[f64; D]],
    ) -> Result<(f64, Vec<[f64; D]>), SoftDtwError> {
        check(x, 'x')?;
        check(y, 'y')?;
        finite_gradient(self.grid(x, y).value_and_gradient())
    }

    /// The normalised value and its gradient with respect to `x` (see [`SoftDtw::normalised`]).
    ///
    /// D(x, x) depends on `x` through both arguments, so half of it contributes the gradient of the first argument
    /// once.
    ///
    /// # Errors
    /// As [`SoftDtw::value_and_gradient`].
    pub fn normalised_and_gradient<const D: usize>(
        &self,
        x: &[[f64; D]],
        y: &[[f64; D]],
    ) -> Result<(f64, Vec<[f64; D]>), SoftDtwError> {
        let (value, mut gradient) = self.value_and_gradient(x, y)?;
        if self.gamma == 0.0 {
            // D(x, x) is 0 for every x.
            return Ok((value, gradient));
        }
        let (self_x, self_gradient) = self.grid(x, x).value_and_gradient();
        let value = normalise(value, self_x, self.self_value(y));
        for (component, of_self) in gradient.as_flattened_mut().iter_mut().zip(self_gradient.as_flattened()) {
            *component -= of_self;
        }
        finite_gradient((value, gradient))
    }
}

fn finite_gradient<const D: usize>(
    (value, gradient): (f64, Vec<[f64; D]>),
) -> Result<(f64, Vec<[f64; D]>), SoftDtwError> {
    finite(value)?;
    if gradient.as_flattened().iter().all(|component| component.is_finite()) {
        Ok((value, gradient))
    } else {
        Err(SoftDtwError::Overflow)
    }
}
