//! A metric that is slowed along a direction stays positive definite and has the stated properties.

use ddl_dynamics::{CholeskyMetric, DynamicsError, Real};
use nalgebra::{DMatrix, SMatrix, Vector2};
use proptest::{prelude::*, test_runner::TestCaseResult};

use crate::{
    draw::{SceneDraw, formed},
    for_every_space,
};

fn smallest_eigenvalue<const D: usize>(matrix: &SMatrix<f64, D, D>) -> f64 {
    DMatrix::from_fn(D, D, |row, column| matrix[(row, column)])
        .symmetric_eigenvalues()
        .min()
}

/// `n^T P' u = share n^T P u`, `share P <= P' <= P`, and `u^T P' u > 0` as computed.
fn slowed_along_a_direction_and_no_more<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let Some(n) = scene.unit::<T, D>() else {
        return Ok(());
    };
    let u = scene.start::<T, D>().try_normalize(T::rounded(1e-30));
    let share = (scene.dt::<T>() / T::rounded(100.0)).min(T::one());
    for metric in scene.metrics::<T, D>() {
        let slowed = metric.damped_along(&n, share).unwrap();
        let (before, after) = (formed(&metric), formed(&slowed));
        let n = n.map(Real::as_f64);
        let share = share.as_f64();
        let tolerance = 64.0 * T::EPSILON.as_f64() * before.norm();
        prop_assert!((after * n - before * n * share).norm() <= tolerance);
        prop_assert!(smallest_eigenvalue(&(after - before * share)) >= -tolerance);
        prop_assert!(smallest_eigenvalue(&(before - after)) >= -tolerance);
        if let Some(u) = u {
            prop_assert!(slowed.quadratic_form(&u) > T::zero());
        }
    }
    Ok(())
}
for_every_space!(slowed_along_a_direction_and_no_more, any_scene);

fn no_finite_input_breaks_it<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let (direction, share) = (scene.direction::<T, D>(), scene.dt::<T>().min(T::one()));
    for metric in scene.metrics::<T, D>() {
        if let Ok(slowed) = metric.damped_along(&direction, share) {
            for axis in 0..D {
                let mut u = nalgebra::SVector::<T, D>::zeros();
                u[axis] = T::one();
                prop_assert!(slowed.quadratic_form(&u) > T::zero());
                prop_assert!(slowed.quadratic_form(&u).is_finite());
            }
        }
    }
    Ok(())
}
for_every_space!(no_finite_input_breaks_it, wild_scene);

#[test]
fn invalid_shares_and_directions_are_refused() {
    let metric = CholeskyMetric::<f64, 2>::identity();
    let axis = Vector2::new(1.0, 0.0);
    for share in [0.0, -1.0, 1.5, f64::NAN] {
        let error = metric.damped_along(&axis, share).unwrap_err();
        assert!(matches!(error, DynamicsError::InvalidShare(_)), "{error}");
    }
    let no_direction = metric.damped_along(&Vector2::zeros(), 0.5);
    assert_eq!(no_direction, Err(DynamicsError::NoDirection));
}

#[test]
fn the_smallest_metric_there_is_can_be_slowed() {
    // The reciprocal of sigma overflows f32.
    let metric = CholeskyMetric::planar(0.0, 0.0, 0.0, 1e-40_f32).unwrap();
    let slowed = metric.damped_along(&Vector2::new(1.0, 0.0), 0.5).unwrap();
    assert!(slowed.eigenvalue_range().smallest > 0.0);
}
