//! The Gaussian bump `exp(-rho^2 |x - c|^2)`: 1 at its centre, and nothing far away.

use nalgebra::SVector;

use crate::{error::DynamicsError, real::Real};

/// `z = rho (x - c)`, so that the bump is `exp(-|z|^2)` (no unit).
///
/// A component is infinite where it is too large for `T`, and never NaN.
pub(super) fn scaled_offset<T: Real, const D: usize>(
    position: &SVector<T, D>,
    centre: &SVector<T, D>,
    rate: T,
) -> SVector<T, D> {
    SVector::from_fn(|i, _| {
        let offset = position[i] - centre[i];
        if offset.is_finite() {
            return offset * rate;
        }
        // The offset of two finite numbers can overflow; half of it cannot.
        let half = T::rounded(0.5);
        let scaled = (position[i] * half - centre[i] * half) * rate;
        scaled + scaled
    })
}

/// `exp(-|z|^2)`, between 0 and 1. Where it is not 0, all components of `z` are small.
pub(super) fn height<T: Real, const D: usize>(scaled_offset: &SVector<T, D>) -> T {
    (-scaled_offset.norm_squared()).exp()
}

/// `rate` itself if it is one: positive and finite.
pub(super) fn ensure_rate<T: Real>(rate: T) -> Result<T, DynamicsError> {
    if rate > T::zero() && rate.is_finite() {
        Ok(rate)
    } else {
        Err(DynamicsError::InvalidRate(rate.as_f64()))
    }
}
