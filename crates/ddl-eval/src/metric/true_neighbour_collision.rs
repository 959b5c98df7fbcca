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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        fixture::{forecast, walk, window},
        metric::collision::{DISC_RADIUS, collides, representative_tracks},
    };

    /// The first is forecast to step to (1, 0), where the second really stands; the second is forecast
    /// far away. Forecast against forecast nobody collides; against the truth the first one does.
    #[test]
    fn the_others_are_where_they_really_were() {
        let still = [0.0, 0.0];
        let window = window(&[still, [1.0, 0.0]], &[still, still]);
        let forecast = forecast(2, &[walk([0.7, 0.0], still), walk([9.0, 0.0], still)]);
        let scene = Scene::new(&window, &forecast).unwrap();
        assert_eq!(collides_with_truth(&scene, DISC_RADIUS), [true, false]);
        assert_eq!(collides_with_truth(&scene, 0.1), [false, false]);
        let forecasts = representative_tracks(&scene);
        assert_eq!(collides(&forecasts, DISC_RADIUS), [false; 2]);
    }

    /// Between the frames (-1, 0.3) and (1, 0.3) the way leads 0.3 m past the origin.
    #[test]
    fn the_way_between_the_frames_counts_and_the_own_future_does_not() {
        let still = [0.0, 0.0];
        let window = window(&[[9.0, 9.0], still], &[still, still]);
        let mut passes = walk([-1.0, 0.3], still);
        passes[6..].fill([1.0, 0.3]);
        let forecast = forecast(2, &[passes, walk(still, still)]);
        let scene = Scene::new(&window, &forecast).unwrap();
        assert_eq!(collides_with_truth(&scene, DISC_RADIUS), [true, false]);
    }
}
