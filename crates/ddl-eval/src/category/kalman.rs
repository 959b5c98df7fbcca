//! A constant-velocity Kalman filter: the expected position of a pedestrian that walks straight on.
//!
//! Each axis separately, in steps of one frame, with the state s = (position, velocity per frame):
//!
//! ```text
//! s(t+1) = [1 1; 0 1] s(t) + noise of covariance 1e-5 I        z(t) = position + noise of 5 cm
//! s(1) ~ N((z(1), 0), I)                                        the forecast: p(8) + 12 v(8)
//! ```
//!
//! Noises and prior are those of `TrajNet++`'s filter, which adapts them by EM and averages random continuations. Here
//! they are fixed, and the continuation is the expected one.

use ddl_core::{HORIZON, Position};

/// Variance of the process noise in a frame: metres squared, and (metres per frame) squared.
const TRANSITION: f64 = 1e-5;
/// Variance of an observed position, square metres.
const OBSERVATION: f64 = 0.05 * 0.05;

/// The expected position of a pedestrian 12 frames after the last observed position, metres.
pub(crate) fn expected_end(observed: &[Position]) -> Position {
    let mut position = observed[0];
    let mut velocity = [0.0, 0.0];
    // The covariance of position and velocity is the same on both axes.
    let [mut pp, mut pv, mut vv] = [1.0, 0.0, 1.0];
    for (t, seen) in observed.iter().enumerate() {
        if t > 0 {
            for axis in 0..2 {
                position[axis] += velocity[axis];
            }
            [pp, pv, vv] = [pp + 2.0 * pv + vv + TRANSITION, pv + vv, vv + TRANSITION];
        }
        let [gain_p, gain_v] = [pp, pv].map(|c| c / (pp + OBSERVATION));
        for axis in 0..2 {
            let surprise = seen[axis] - position[axis];
            position[axis] += gain_p * surprise;
            velocity[axis] += gain_v * surprise;
        }
        [pp, pv, vv] = [(1.0 - gain_p) * pp, (1.0 - gain_p) * pv, vv - gain_v * pv];
    }
    [0, 1].map(|axis| position[axis] + HORIZON as f64 * velocity[axis])
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// The expected numbers are printed by `tests/reference/distribution.py`: the same filter, written with numpy
    /// matrices from the equations above.
    #[test]
    fn a_crooked_walk_as_computed_elsewhere() {
        let walk = [
            [0.0, 0.0],
            [0.4, 0.1],
            [0.9, 0.1],
            [1.3, 0.3],
            [1.6, 0.6],
            [2.1, 0.7],
            [2.4, 1.1],
            [2.9, 1.2],
        ];
        let end = expected_end(&walk);
        assert_relative_eq!(end[0], 7.757_791_477_031_529, epsilon = 1e-12);
        assert_relative_eq!(end[1], 3.402_978_619_963_234, epsilon = 1e-12);
    }
}
