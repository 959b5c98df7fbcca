//! Collisions of a forecast with where the others really went: Col-II of `TrajNet++`.
//!
//! As in [`collision`](super::collision), but pedestrian i follows its representative hypothesis `x_i`, and everybody
//! else j, forecast or not, the TRUE future `p_j`:
//!
//! ```text
//! i collides when min over j and t in [1, 12] of |x_i(t) - p_j(t)| < 2 r = 0.4 m
//! rate = pedestrians who collide / pedestrians, in [0, 1]
//! ```
//!
//! A forecast that stays far from everybody because it is wrong scores well: read it beside the errors.
//!
//! # References
//! Kothari, Kreiss, Alahi, "Human Trajectory Forecasting in Crowds" (`TrajNet++`), T-ITS 2021.

use super::collision::closest_approach;
use crate::Scene;

/// Which pedestrians' representative forecasts run into the true future of another; `[N]`.
pub fn collides_with_truth(scene: &Scene<'_>, radius: f64) -> Vec<bool> {
    let (forecast, everybody) = (scene.forecast(), scene.everybody());
    let runs_into_another = |i: usize| {
        let track = forecast.hypothesis(i, forecast.representative(i));
        let own = scene.place(i);
        (0..everybody.len())
            .any(|j| j != own && closest_approach(track, everybody.future(j)) < 2.0 * radius)
    };
    (0..scene.pedestrians()).map(runs_into_another).collect()
}
