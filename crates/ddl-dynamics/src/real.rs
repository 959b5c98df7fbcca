//! The number types of the crate: `f32` and `f64`.

use nalgebra::RealField;

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// A floating-point number: `f32` or `f64`. Sealed, because the guarantees of this crate are proved for IEEE 754 binary
/// numbers with round-to-nearest and gradual underflow.
pub trait Real: RealField + Copy + sealed::Sealed {
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;
    /// Smallest positive normal number.
    const MIN_POSITIVE: Self;
    /// Largest finite number.
    const MAX: Self;

    /// The nearest number of this type; infinite when `value` is too large for it.
    fn rounded(value: f64) -> Self;

    /// The same number as `f64`, exactly.
    fn as_f64(self) -> f64;
}

impl Real for f32 {
    const EPSILON: Self = f32::EPSILON;
    const MIN_POSITIVE: Self = f32::MIN_POSITIVE;
    const MAX: Self = f32::MAX;

    fn rounded(value: f64) -> Self {
        value as f32
    }

    fn as_f64(self) -> f64 {
        f64::from(self)
    }
}

impl Real for f64 {
    const EPSILON: Self = f64::EPSILON;
    const MIN_POSITIVE: Self = f64::MIN_POSITIVE;
    const MAX: Self = f64::MAX;

    fn rounded(value: f64) -> Self {
        value
    }

    fn as_f64(self) -> f64 {
        self
    }
}
