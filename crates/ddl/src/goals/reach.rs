//! Goals within the reach of a pedestrian.

use ddl_core::{HORIZON, OBSERVED, Position, Window};
use ddl_goal::GoalSet;
use ddl_network::motion_bounds;
use rayon::prelude::*;

/// Widening of the goals for each metre that the observation adds to the standard deviation of an endpoint. Chosen on
/// dut with noise of 10 and 20 cm (docs/tried.md): more gains nothing there; citr gains as much, juelich nothing.
const WIDENING: f64 = 1.5;

/// Widens the goals of pedestrians that are not well observed, and moves goals beyond the pedestrian's reach closer: to
/// the distance that it covers at its top speed within the horizon.
pub(crate) fn within(window: &Window, sets: Vec<GoalSet>, time_step: f64) -> Vec<GoalSet> {
    let reachable = |(i, set): (usize, GoalSet)| {
        let observed = window.observed(i);
        let set = set.widened_by(WIDENING * window.quality(i).uncertainty());
        clamped(set, observed, time_step)
    };
    sets.into_par_iter().enumerate().map(reachable).collect()
}

/// The goals of a pedestrian with these observed positions, moved within its reach.
pub(crate) fn clamped(set: GoalSet, observed: &[Position], time_step: f64) -> GoalSet {
    let top_speed = motion_bounds(observed, time_step, 0.0).top_speed();
    set.clamped_to(observed[OBSERVED - 1], top_speed * time_step * HORIZON as f64)
}
