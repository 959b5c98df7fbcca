//! The number types of the crate: `f32` and `f64`.

use nalgebra::RealField;

mod sealed {
    pub trait Sealed {}
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

macro_rules! real {
    ($($number:ident),*) => {$(
        impl sealed::Sealed for $number {}

        impl Real for $number {
            const EPSILON: Self = $number::EPSILON;
            const MIN_POSITIVE: Self = $number::MIN_POSITIVE;
            const MAX: Self = $number::MAX;

            fn rounded(value: f64) -> Self {
                value as Self
            }

            fn as_f64(self) -> f64 {
                self.into()
            }
        }
    )*};
}
real!(f32, f64);
