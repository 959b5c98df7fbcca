//! Properties of the crate, each in `f32` and `f64` and in one, two and three dimensions.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::cast_sign_loss, reason = "numbers of steps are computed as positive floats")]

mod certificate;
mod convergence;
mod draw;
mod metric;
mod motion_bounds;
mod stable_euler;

/// Runs a law, a function `fn law<T: Real, const D: usize>(draw) -> TestCaseResult`, on random draws of a strategy in
/// every number type and dimension.
macro_rules! for_every_space {
    ($law:ident, $draw:ident) => {
        mod $law {
            proptest::proptest! {
                #![proptest_config(proptest::prelude::ProptestConfig::with_cases(1000))]
                #[test]
                fn f32_1d(draw in super::super::draw::$draw()) { super::$law::<f32, 1>(&draw)?; }
                #[test]
                fn f32_2d(draw in super::super::draw::$draw()) { super::$law::<f32, 2>(&draw)?; }
                #[test]
                fn f32_3d(draw in super::super::draw::$draw()) { super::$law::<f32, 3>(&draw)?; }
                #[test]
                fn f64_1d(draw in super::super::draw::$draw()) { super::$law::<f64, 1>(&draw)?; }
                #[test]
                fn f64_2d(draw in super::super::draw::$draw()) { super::$law::<f64, 2>(&draw)?; }
                #[test]
                fn f64_3d(draw in super::super::draw::$draw()) { super::$law::<f64, 3>(&draw)?; }
            }
        }
    };
}
pub(crate) use for_every_space;
