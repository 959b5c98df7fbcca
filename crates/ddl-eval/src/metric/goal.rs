//! How near the goals come to where the walkers end.
//!
//! ```text
//! goal FDE_i = min_k |g_{i,k} - p_i(T)|        metres
//! ```
//!
//! It bounds what any model that converges to its goals can reach by then, and is the error of the
//! goal estimator alone. The goal of a walker still under way lies beyond the 12th frame; here a goal
//! is compared with the last true position all the same, because that is what estimators are fit to.

use super::displacement::distance;
use crate::Scene;

/// Distance of the nearest goal of pedestrian `i` from the true end, metres; `None` without goals.
///
/// # Panics
/// When `i` is out of range.
#[must_use]
pub fn goal_fde(scene: &Scene<'_>, i: usize) -> Option<f64> {
    let end = scene.window().end(i)?;
    (0..scene.hypotheses())
        .map(|k| scene.forecast().goal(i, k).map(|goal| distance(goal, end)))
        .try_fold(f64::INFINITY, |least, d| d.map(|d| least.min(d)))
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::{
        Forecast,
        metric::fixture::{walk, window},
    };

    #[test]
    fn the_nearest_goal_counts_whatever_its_weight() {
        let window = window(&[[0.0, 0.0]], &[[0.5, 0.0]]);
        let walks = [walk([0.0; 2], [0.5, 0.0]), walk([0.0; 2], [0.5, 0.0])].concat();
        let goals = Some(vec![[0.0, 0.0], [6.0, 0.25]]);
        let forecast = Forecast::new(1, 2, walks.clone(), vec![0.9, 0.1], goals).unwrap();
        let fde = goal_fde(&Scene::new(&window, &forecast).unwrap(), 0);
        assert_relative_eq!(fde.unwrap(), 0.25, epsilon = 1e-12);
        let without = Forecast::equally_likely(1, 2, walks).unwrap();
        assert_eq!(goal_fde(&Scene::new(&window, &without).unwrap(), 0), None);
    }
}
