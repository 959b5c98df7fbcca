//! Densities and Mahalanobis distances computed with scipy and numpy: `tests/reference/distribution.py`.
use approx::assert_relative_eq;
use ddl_core::Position;
use serde::Deserialize;

use crate::metric::gaussian::PointMoments;
use crate::metric::kde::{MIN_DEVIATION, log_density};

#[derive(Deserialize)]
struct ReferenceScores {
    cases: Vec<ScoredCase>,
}

#[derive(Deserialize)]
struct ScoredCase {
    points: Vec<Position>,
    weights: Vec<f64>,
    at: Position,
    log_density: f64,
    mahalanobis: f64,
    eigenvalue: f64,
}

#[test]
fn densities_and_distances_in_deviations_agree_with_scipy_and_numpy() {
    let text = include_str!("../../tests/reference/distribution.json");
    let ReferenceScores { cases } = serde_json::from_str(text).unwrap();
    assert_eq!(cases.len(), 21);
    let agree = |actual: f64, expected: f64| {
        assert_relative_eq!(actual, expected, epsilon = 1e-10, max_relative = 1e-10);
    };
    for case in cases {
        agree(log_density(&case.points, &case.weights, case.at), case.log_density);
        let moments = PointMoments::of(&case.points, &case.weights);
        let axes = moments.covariance.principal_axes().with_least_eigenvalues(MIN_DEVIATION * MIN_DEVIATION);
        let off = [case.at[0] - moments.mean[0], case.at[1] - moments.mean[1]];
        if axes.variances[1] > MIN_DEVIATION * MIN_DEVIATION {
            agree(axes.covariance().xy, moments.covariance.xy);
        }
        agree(axes.mahalanobis_squared(off).sqrt(), case.mahalanobis);
        agree(axes.variances[0], case.eigenvalue);
    }
}
