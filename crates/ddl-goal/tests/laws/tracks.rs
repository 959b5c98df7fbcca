//! Synthetic tracks for the tests.

pub(crate) use ddl_core::distance;
use ddl_goal::{ExpertLibrary, GoalEstimator, GoalEstimatorParams};

pub(crate) type Positions = Vec<[f64; 2]>;

/// 20 positions (m), 0.4 s apart, of a pedestrian that turns by `turn` (rad) at each step.
pub(crate) fn walk(speed: f64, heading: f64, turn: f64) -> Positions {
    let mut position = [3.0 * heading, -speed];
    (0..20)
        .map(|i| {
            let here = position;
            let (sin, cos) = (heading + turn * f64::from(i)).sin_cos();
            position = [here[0] + 0.4 * speed * cos, here[1] + 0.4 * speed * sin];
            here
        })
        .collect()
}

pub(crate) fn estimator(params: GoalEstimatorParams, tracks: Vec<Positions>) -> GoalEstimator {
    GoalEstimator::new(params, ExpertLibrary::new(tracks, 0.4).unwrap()).unwrap()
}
