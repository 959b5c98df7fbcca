//! Densities and Mahalanobis distances computed with scipy and numpy: `tests/reference/distribution.py`.
use approx::assert_relative_eq;
use ddl_data::Position;
use ddl_eval::metric::{
    gaussian::Moments,
    kde::{LEAST_DEVIATION, log_density},
};
use serde::Deserialize;

#[derive(Deserialize)]
struct Reference {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    points: Vec<Position>,
    weights: Vec<f64>,
    at: Position,
    log_density: f64,
    mahalanobis: f64,
    eigenvalue: f64,
}

fn cases() -> Vec<Case> {
    let text = include_str!("../reference/distribution.json");
    serde_json::from_str::<Reference>(text).unwrap().cases
}

#[test]
fn densities_agree_with_scipy() {
    let cases = cases();
    assert_eq!(cases.len(), 21);
    for case in cases {
        let found = log_density(&case.points, &case.weights, case.at);
        assert_relative_eq!(
            found,
            case.log_density,
            epsilon = 1e-10,
            max_relative = 1e-10
        );
    }
}

#[test]
fn distances_in_deviations_agree_with_numpy() {
    for case in cases() {
        let moments = Moments::of(&case.points, &case.weights);
        let axes = moments.covariance.principal_axes();
        let axes = axes.raised_to(LEAST_DEVIATION * LEAST_DEVIATION);
        let off = [case.at[0] - moments.mean[0], case.at[1] - moments.mean[1]];
        let found = axes.mahalanobis_squared(off).sqrt();
        assert_relative_eq!(
            found,
            case.mahalanobis,
            epsilon = 1e-10,
            max_relative = 1e-10
        );
        assert_relative_eq!(axes.variances[0], case.eigenvalue, max_relative = 1e-10);
    }
}
