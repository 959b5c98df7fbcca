//! `P` is symmetric and positive definite, and applied like the formed matrix.

use crate::{
    draw::{SceneDraw, formed},
    for_every_space,
};
use ddl_dynamics::{CholeskyMetric, Real};
use nalgebra::DMatrix;
use proptest::{prelude::*, test_runner::TestCaseResult};

fn applied_as_formed<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let Some(u) = scene.unit::<T, D>() else { return Ok(()) };
    let u64 = u.map(Real::as_f64);
    for metric in scene.metrics::<T, D>() {
        let p = formed(&metric);
        let tolerance = 8.0 * D as f64 * T::EPSILON.as_f64() * p.norm();
        prop_assert!((metric.apply(&u).map(Real::as_f64) - p * u64).norm() <= tolerance);
        let form = metric.quadratic_form(&u).as_f64();
        prop_assert!((form - u64.dot(&(p * u64))).abs() <= tolerance);
        // As computed: `u^T P u >= sigma` up to one rounding of `|u|^2`.
        prop_assert!(form > 0.0);
        prop_assert!(form >= metric.sigma().as_f64() * (1.0 - 8.0 * T::EPSILON.as_f64()));
    }
    Ok(())
}
for_every_space!(applied_as_formed, any_scene);

/// The eigenvalues agree with nalgebra's symmetric eigendecomposition of the formed matrix, and enclose the quadratic
/// form of every unit vector.
fn eigenvalues_agree_and_enclose<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let unit = scene.unit::<T, D>();
    for metric in scene.metrics::<T, D>() {
        let range = metric.eigenvalue_range();
        let p = formed(&metric);
        let eigenvalues = DMatrix::from_fn(D, D, |row, column| p[(row, column)]).symmetric_eigenvalues();
        let tolerance = 32.0 * T::EPSILON.as_f64() * p.norm();
        prop_assert!((range.smallest.as_f64() - eigenvalues.min()).abs() <= tolerance);
        prop_assert!((range.largest.as_f64() - eigenvalues.max()).abs() <= tolerance);
        prop_assert!(range.smallest >= metric.sigma());
        if let Some(u) = unit {
            let form = metric.quadratic_form(&u).as_f64();
            prop_assert!(form >= range.smallest.as_f64() - tolerance);
            prop_assert!(form <= range.largest.as_f64() + tolerance);
        }
    }
    Ok(())
}
for_every_space!(eigenvalues_agree_and_enclose, any_scene);

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// In the plane the closed form keeps all digits, even close to singular: with a negligible sigma, the product of
    /// the eigenvalues is `(a c)^2` and their sum `a^2 + b^2 + c^2`.
    #[test]
    fn planar_eigenvalues_keep_their_digits(
        a in -8.0..=3.0_f64,
        b in -8.0..=3.0_f64,
        c in -8.0..=3.0_f64,
    ) {
        let (a, b, c) = (10_f64.powf(a), -(10_f64.powf(b)), 10_f64.powf(c));
        let range = CholeskyMetric::planar(a, b, c, 1e-300).unwrap().eigenvalue_range();
        let product = (a * c).powi(2);
        prop_assert!((range.smallest * range.largest / product - 1.0).abs() < 1e-14);
        let sum = a * a + b * b + c * c;
        prop_assert!(((range.smallest + range.largest) / sum - 1.0).abs() < 1e-14);
    }
}
