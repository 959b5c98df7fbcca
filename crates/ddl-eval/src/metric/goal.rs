//! How near the goals come to where the pedestrians end.
//!
//! ```text
//! goal FDE_i = min_k |g_{i,k} - p_i(T)|        metres
//! ```
//!
//! It bounds what any model that converges to its goals can reach by then, and is the error of the
//! goal estimator alone. The goal of a pedestrian still under way lies beyond the 12th frame; here a goal
//! is compared with the last true position all the same, because that is what estimators are fit to.

use super::displacement::distance;
use crate::Scene;

/// Distance of the nearest goal of pedestrian `i` from the true end, metres; `None` without goals.
///
/// # Examples
/// ```
/// use ddl_data::{PedestrianId, Window};
/// use ddl_eval::metric::goal::goal_fde;
/// use ddl_eval::{Forecast, Scene};
///
/// let walk = (0..20).map(|t| [0.5 * f64::from(t), 0.0]).collect(); // ends at (9.5, 0) m
/// let window = Window::new("yard", 0, 10, vec![PedestrianId(1)], vec![walk])?;
/// let goals = vec![[9.5, 2.0], [8.5, 0.0]];
/// let positions = vec![[3.5, 0.0]; 2 * 12];
/// let forecast = Forecast::new(1, 2, positions, vec![0.5, 0.5], Some(goals))?;
/// assert_eq!(goal_fde(&Scene::new(&window, &forecast)?, 0), Some(1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn goal_fde(scene: &Scene<'_>, i: usize) -> Option<f64> {
    let end = scene.window().end(i)?;
    (0..scene.hypotheses())
        .map(|k| scene.forecast().goal(i, k).map(|goal| distance(goal, end)))
        .try_fold(f64::INFINITY, |least, d| d.map(|d| least.min(d)))
}
