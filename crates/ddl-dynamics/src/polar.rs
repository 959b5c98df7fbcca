//! Polar form of a vector: its length and its direction, without overflow or underflow.

use crate::real::Real;
use nalgebra::SVector;

/// Length of `vector` and the unit vector along it; `(0, 0)` for the zero vector.
///
/// # Numerics
/// A vector whose squares underflow or overflow is divided by its largest component first, so the direction is accurate
/// down to subnormal components. The length may be infinite; the direction is still exact to rounding. A component that
/// is not finite gives NaN.
#[inline]
pub(crate) fn polar<T: Real, const D: usize>(vector: &SVector<T, D>) -> (T, SVector<T, D>) {
    let square = vector.norm_squared();
    if square >= T::MIN_POSITIVE / T::EPSILON && square.is_finite() {
        let length = square.sqrt();
        return (length, vector / length);
    }
    if *vector == SVector::<T, D>::zeros() {
        return (T::zero(), SVector::zeros());
    }
    let largest = vector.amax();
    // Divided, not multiplied by 1 / largest: the reciprocal of a subnormal number overflows.
    let scaled = vector / largest;
    let scaled_length = scaled.norm();
    (largest * scaled_length, scaled / scaled_length)
}

/// The length of `to - from` and the unit vector along it, also if the difference is too large for `T`.
#[inline]
pub(crate) fn polar_way<T: Real, const D: usize>(from: &SVector<T, D>, to: &SVector<T, D>) -> (T, SVector<T, D>) {
    let (length, direction) = polar(&(to - from));
    if length.is_finite() {
        return (length, direction);
    }
    // The difference of two finite points can overflow, but half of it cannot.
    let half = T::rounded(0.5);
    let (half_length, direction) = polar(&(to * half - from * half));
    (half_length + half_length, direction)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::polar;

    #[test]
    fn three_four_five_at_every_scale() {
        for scale in [4.9e-324_f64, 1e-310, 1e-160, 1e-12, 1.0, 1e12, 1e160, 3e307] {
            let (length, unit) = polar(&Vector2::new(3.0 * scale, -4.0 * scale));
            assert!((length / (5.0 * scale) - 1.0).abs() <= 4.0 * f64::EPSILON, "{scale}");
            assert!((unit - Vector2::new(0.6, -0.8)).norm() <= 4.0 * f64::EPSILON, "{scale}");
        }
    }

    #[test]
    fn zero_has_no_direction_and_nan_stays_nan() {
        assert_eq!(polar(&Vector2::new(0.0_f32, -0.0)), (0.0, Vector2::zeros()));
        assert!(polar(&Vector2::new(0.0_f32, f32::NAN)).1.x.is_nan());
    }
}
