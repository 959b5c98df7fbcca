//! Endpoints that the places of the training may lack: a pedestrian stops at once, turns to either side or turns back.

use ddl_core::motion::RECENT_STEPS;
use ddl_core::{HORIZON, OBSERVED, Position};
use ddl_network::ProposedEndpoints;

/// Angle from the heading in right angles, and share of the way that the pedestrian would cover straight on.
const WAYS: [(f64, f64); 4] = [(0.0, 0.0), (1.0, 0.6), (-1.0, 0.6), (2.0, 0.5)];
/// Least speed at which the pedestrian turns away, m/s.
const LEAST_SPEED: f64 = 0.3;

/// Adds the four endpoints, with this probability each. The pedestrian was observed at these positions of its own frame
/// (m), `time_step` seconds apart. The shares were chosen on whole places left out (`docs/tried.md`).
pub(crate) fn add(proposed: &mut ProposedEndpoints, share: f64, observed: &[Position; OBSERVED], time_step: f64) {
    let [x, y] = [0, 1].map(|axis| observed[OBSERVED - 1][axis] - observed[OBSERVED - 1 - RECENT_STEPS][axis]);
    let speed = x.hypot(y) / (RECENT_STEPS as f64 * time_step);
    let straight_on = speed.max(LEAST_SPEED) * HORIZON as f64 * time_step;
    let total: f64 = proposed.weights.iter().sum();
    for (angle, way) in WAYS {
        let (sin, cos) = (angle * std::f64::consts::FRAC_PI_2).sin_cos();
        proposed.endpoints.push([cos, sin].map(|axis| way * straight_on * axis));
        proposed.weights.push(share * total);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve: 1.5 m in the last three steps of 0.5 s, so 6 m in twelve. A slow pedestrian turns away at 0.3 m/s.
    #[test]
    fn endpoints_of_a_pedestrian_by_hand() {
        let observed = std::array::from_fn(|t| [0.3 * (t as f64 - 7.0), 0.4 * (t.max(4) as f64 - 7.0)]);
        let mut proposed = ProposedEndpoints { endpoints: vec![[4.8, 0.0]], weights: vec![0.5] };
        add(&mut proposed, 0.01, &observed, 0.5);
        let weights = proposed.weights.clone();
        add(&mut proposed, 0.01, &[[2.0, 1.0]; OBSERVED], 0.5);
        let expected = [[4.8, 0.0], [0.0, 0.0], [0.0, 3.6], [0.0, -3.6], [-3.0, 0.0], [0.0, 0.0], [0.0, 1.08]];
        for (found, expected) in proposed.endpoints.iter().zip(expected) {
            assert!((found[0] - expected[0]).hypot(found[1] - expected[1]) < 1e-12, "{found:?}");
        }
        assert_eq!(weights, [0.5, 0.005, 0.005, 0.005, 0.005]);
    }
}
