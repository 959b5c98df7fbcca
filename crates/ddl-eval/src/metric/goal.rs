//! How near the goals come to where the pedestrians end.
//!
//! ```text
//! goal FDE_i = min_k |g_{i,k} - p_i(T)|        metres
//! ```
//!
//! The error of the goal estimator alone, and the least that a model which converges to its goals can have. The goal of
//! a pedestrian still under way lies beyond the 12th frame; it is compared with the last true position all the same.

use super::displacement::distance;
use crate::Scene;

/// Distance of the nearest goal of pedestrian `i` from the true end, metres; `None` without goals.
pub fn goal_fde(scene: &Scene<'_>, i: usize) -> Option<f64> {
    let end = scene.window().end(i)?;
    (0..scene.hypotheses())
        .map(|k| scene.forecast().goal(i, k).map(|goal| distance(goal, end)))
        .try_fold(f64::INFINITY, |least, d| d.map(|d| least.min(d)))
}
