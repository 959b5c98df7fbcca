//! Collisions of a forecast with where the others really went.
//!
//! As in [`collision`](super::collision), pedestrians are discs of radius r = 0.2 m, and tracks are
//! straight from frame to frame, with the exact minimum over time. Pedestrian i follows its
//! representative hypothesis `x_i`, everybody else j, forecast or not, its TRUE future `p_j`:
//!
//! ```text
//! i collides when min over j and t in [1, 12] of |x_i(t) - p_j(t)| < 2 r = 0.4 m
//! rate = pedestrians who collide / pedestrians, in [0, 1]
//! ```
//!
//! It asks whether a forecast walks through people, where the rate between forecasts asks whether the
//! forecasts of one scene agree with one another. `TrajNet++` calls this one Col-II and that one Col-I;
//! it takes centres closer than 0.2 m. People who walk together come this close in truth too: compare
//! with the rate of the true futures. A forecast that stays far from everybody because it is wrong
//! scores well: read it beside the errors.
//!
//! # References
//! Kothari, Kreiss, Alahi, "Human Trajectory Forecasting in Crowds" (`TrajNet++`), T-ITS 2021.

use super::collision::closest_approach;
use crate::Scene;

/// Which pedestrians' representative forecasts run into the true future of another.
///
/// # Shapes
/// `[N]`.
#[must_use]
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
