//! Stability of rollouts: whether the forecast positions approach their goals.
//!
//! Phi(t) = |p(t) - g| is the distance to the goal, the Lyapunov function of DDL (its potential), from the last
//! observed position (t = 0) to the 12th forecast frame. For each rollout, that is each hypothesis of each pedestrian:
//!
//! ```text
//! decreasing     Phi(t+1) < Phi(t) at every step t = 0..11, or both are at the goal (within 1 mm)
//! end distance   Phi(12)                                                            metres
//! largest turn   max_t angle between p(t+1) - p(t) and g - p(t)                     degrees, [0, 180]
//! certified      the model's certificate of the rollout holds, if it has one
//! ```
//!
//! Steps shorter than 1 mm, and steps that start within 1 mm of the goal, have no direction and no turn.
//!
//! # References
//! DDL (Wang, Zhi, Batista, Chandra, ICRA 2024), section II-E: v = -P grad Phi.

use ddl_core::{Position, distance};
use serde::{Deserialize, Serialize};

use crate::metric::displacement::{minus, turn};
use crate::scored_window::ScoredWindow;

/// Distance (metres) within which a pedestrian is at the goal, and length below which a step has no direction.
pub(crate) const GOAL_TOLERANCE: f64 = 1e-3;

/// Behaviour of one rollout towards its goal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RolloutStability {
    /// Whether the distance to the goal decreases at every step.
    pub decreasing: bool,
    /// Distance to the goal at the last frame, metres.
    pub end_distance: f64,
    /// Largest angle between a step and the direction to the goal, degrees.
    pub largest_turn: f64,
    /// Whether the model's certificate of the rollout holds; `None` without a certificate.
    pub certified: Option<bool>,
}

impl RolloutStability {
    /// Checks the rollout `path` from `start` against `goal`, all in metres, without a certificate.
    pub fn of(start: Position, path: &[Position], goal: Position) -> Self {
        let mut result =
            Self { decreasing: true, end_distance: distance(start, goal), largest_turn: 0.0, certified: None };
        let mut here = start;
        for &next in path {
            let (before, after) = (distance(here, goal), distance(next, goal));
            result.decreasing &= after < before || before.max(after) <= GOAL_TOLERANCE;
            if before > GOAL_TOLERANCE && distance(here, next) > GOAL_TOLERANCE {
                result.largest_turn = result.largest_turn.max(turn(minus(next, here), minus(goal, here)).abs());
            }
            result.end_distance = after;
            here = next;
        }
        result
    }
}

/// Means over the rollouts of a test set.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StabilityScores {
    /// Number of rollouts: hypotheses of all pedestrians.
    pub rollouts: usize,
    /// Share of rollouts whose distance to the goal decreases at every step, in [0, 1].
    pub decreasing: f64,
    /// Mean distance to the goal at the last frame, metres.
    pub end_distance: f64,
    /// Mean over the rollouts of the largest turn away from the goal direction, degrees.
    pub largest_turn: f64,
    /// Share of rollouts with a turn of more than 90 degrees, a step away from the goal, in [0, 1].
    pub reversing: f64,
    /// Share of rollouts whose certificate holds, in [0, 1]; `None` unless all have a certificate.
    pub certified: Option<f64>,
}

impl StabilityScores {
    /// The means of rollouts; `None` without rollouts.
    pub(crate) fn mean(rollouts: &[RolloutStability]) -> Option<Self> {
        if rollouts.is_empty() {
            return None;
        }
        let n = rollouts.len() as f64;
        let mean = |metric: fn(&RolloutStability) -> f64| rollouts.iter().map(metric).sum::<f64>() / n;
        let share = |holds: fn(&RolloutStability) -> bool| rollouts.iter().filter(|&r| holds(r)).count() as f64 / n;
        let all_have_one = rollouts.iter().all(|r| r.certified.is_some());
        Some(Self {
            rollouts: rollouts.len(),
            decreasing: share(|r| r.decreasing),
            end_distance: mean(|r| r.end_distance),
            largest_turn: mean(|r| r.largest_turn),
            reversing: share(|r| r.largest_turn > 90.0),
            certified: all_have_one.then(|| share(|r| r.certified == Some(true))),
        })
    }
}

/// Checks every hypothesis of every pedestrian; empty when the forecast has no goals.
pub(crate) fn rollouts(scene: &ScoredWindow<'_>) -> Vec<RolloutStability> {
    let forecast = scene.forecast();
    (0..scene.pedestrians())
        .flat_map(|i| (0..scene.hypotheses()).map(move |k| (i, k)))
        .filter_map(|(i, k)| {
            let goal = forecast.goal(i, k)?;
            let judged = RolloutStability::of(scene.last_observed(i), forecast.hypothesis(i, k), goal);
            let certified = forecast.certified(i, k);
            Some(RolloutStability { certified, ..judged })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Back and forth by 0.4 mm at the start and at the goal, which has no direction.
    #[test]
    fn a_step_without_a_direction_has_no_turn() {
        let path = [[-4e-4, 0.0], [1.0, 1.5], [2.0, 3.0], [2.0004, 3.0], [1.0, 1.5]];
        let found = RolloutStability::of([0.0, 0.0], &path[..4], [2.0, 3.0]);
        assert!(found.largest_turn < 0.1 && !found.decreasing, "{found:?}");
        assert!((found.end_distance - 4e-4).abs() < 1e-9);
        assert!(RolloutStability::of([0.0, 0.0], &path[1..4], [2.0, 3.0]).decreasing);
        let found = RolloutStability::of([0.0, 0.0], &path[1..], [2.0, 3.0]);
        assert!(!found.decreasing && found.largest_turn < 0.1, "{found:?}");
    }
}
