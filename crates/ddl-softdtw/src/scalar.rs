//! The number types of sequences: `f32` and `f64`.

mod sealed {
    pub trait SealedScalar {}
    impl SealedScalar for f32 {}
    impl SealedScalar for f64 {}
}

/// Component of a step: `f32` or `f64`. All results are computed in `f64` and rounded once at the end. The trait is
/// sealed, because this is proved only for these two types.
pub trait Scalar: sealed::SealedScalar + Copy + PartialEq + std::fmt::Debug + Send + Sync + 'static {
    /// The same number as `f64`, exactly.
    fn widened(self) -> f64;

    /// The nearest number of this type; infinite when `value` is too large for it.
    fn rounded(value: f64) -> Self;
}

impl Scalar for f32 {
    fn widened(self) -> f64 {
        f64::from(self)
    }

    fn rounded(value: f64) -> Self {
        value as f32
    }
}

impl Scalar for f64 {
    fn widened(self) -> f64 {
        self
    }

    fn rounded(value: f64) -> Self {
        value
    }
}

#[expect(clippy::inline_always, reason = "the lanes of a strip must stay in registers")]
#[inline(always)]
pub(crate) fn widened<T: Scalar, const D: usize>(step: &[T; D]) -> [f64; D] {
    let mut wide = [0.0; D];
    for (wide, component) in wide.iter_mut().zip(step) {
        *wide = component.widened();
    }
    wide
}
