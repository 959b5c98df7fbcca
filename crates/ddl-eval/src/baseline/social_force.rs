//! The social force model: pedestrians keep their velocity and avoid each other.

use ddl_core::{Forecast, ForecastError, Forecaster, HORIZON, OBSERVED, Position, TIME_STEP, Window};
use rayon::prelude::*;

/// Relaxation time towards the desired velocity: tau, s.
const RELAXATION: f64 = 0.5;
/// Strength of the repulsive potential: V0, m^2/s^2.
const STRENGTH: f64 = 2.1;
/// Range of the potential: sigma, m.
const REACH: f64 = 0.3;
/// Time of the anticipated step of others, which shapes the ellipses, s.
const FORESIGHT: f64 = 2.0;
/// Half the angle of sight: phi, degrees.
const HALF_SIGHT: f64 = 100.0;
/// Weight of pedestrians out of sight: c.
const OUT_OF_SIGHT: f64 = 0.5;
/// Largest speed as a multiple of the desired speed.
const TOP_SPEED: f64 = 1.3;
/// Integration steps in one frame of 0.4 s.
const SUBSTEPS: usize = 8;
/// Semi-minor axis beyond which the repulsion is below 3e-6 m/s^2, m.
const NEGLIGIBLE: f64 = 15.0 * REACH;

/// The social force model of Helbing and Molnar, for all pedestrians of a window together; one hypothesis.
///
/// The desired velocity of a pedestrian is that of its last observed step, `v0 = (p(8) - p(7)) / 0.4 s` along `e`.
/// Every other pedestrian b repels it, in an ellipse of its anticipated step `s = 2 s * |v_b|` along `e_b`:
///
/// ```text
/// dv/dt = (v0 - v) / tau - sum_b w grad V(r)              r = x - x_b, m; tau = 0.5 s
/// V = V0 exp(-B / sigma)                                  V0 = 2.1 m^2/s^2, sigma = 0.3 m
/// 2 B = sqrt((|r| + |r - s e_b|)^2 - s^2)                 semi-minor axis of an ellipse, m
/// w = 1 within 100 degrees of e, else 0.5;  |v| <= 1.3 |v0|
/// ```
///
/// Integrated by Euler in steps of 0.05 s. It has no walls, fluctuations and attractions, unlike the paper.
///
/// # References
/// Helbing and Molnar, "Social force model for pedestrian dynamics", Physical Review E 51 (1995).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SocialForce;

impl Forecaster for SocialForce {
    fn name(&self) -> String {
        "social force".to_owned()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        let n = window.len();
        let mut pedestrians: Vec<ForcedPedestrian> = (0..n).map(|i| ForcedPedestrian::of(window.observed(i))).collect();
        let mut positions = vec![[0.0, 0.0]; n * HORIZON];
        let mut forces = vec![[0.0, 0.0]; n];
        for t in 0..HORIZON {
            for _ in 0..SUBSTEPS {
                for (i, force) in forces.iter_mut().enumerate() {
                    *force = pedestrians[i].force(i, &pedestrians);
                }
                for (pedestrian, force) in pedestrians.iter_mut().zip(&forces) {
                    pedestrian.advance(*force);
                }
            }
            for (i, pedestrian) in pedestrians.iter().enumerate() {
                positions[i * HORIZON + t] = pedestrian.position;
            }
        }
        Ok(Forecast::with_equal_weights(n, 1, positions)?)
    }

    fn forecast_all(&self, windows: &[Window]) -> Result<Vec<Forecast>, ForecastError> {
        windows.par_iter().map(|window| self.forecast(window)).collect()
    }
}

struct ForcedPedestrian {
    position: Position,
    velocity: Position,
    desired: Position,
    /// Direction of the desired velocity; zero for a standing pedestrian.
    direction: Position,
    top_speed: f64,
    /// Length of the anticipated step, m.
    stride: f64,
}

impl ForcedPedestrian {
    fn of(observed: &[Position]) -> Self {
        let (before, position) = (observed[OBSERVED - 2], observed[OBSERVED - 1]);
        let desired = [0, 1].map(|c| (position[c] - before[c]) / TIME_STEP);
        let speed = length(desired);
        let direction = if speed > 0.0 { desired.map(|c| c / speed) } else { [0.0, 0.0] };
        Self {
            position,
            velocity: desired,
            desired,
            direction,
            top_speed: TOP_SPEED * speed,
            stride: FORESIGHT * speed,
        }
    }

    /// Acceleration of this pedestrian, number `i` of all, m/s^2.
    fn force(&self, i: usize, pedestrians: &[ForcedPedestrian]) -> Position {
        let mut sum = [0, 1].map(|c| (self.desired[c] - self.velocity[c]) / RELAXATION);
        if self.top_speed == 0.0 {
            return sum;
        }
        let sight = HALF_SIGHT.to_radians().cos();
        for (j, other) in pedestrians.iter().enumerate() {
            if j == i {
                continue;
            }
            let push = self.push_of(other);
            // The other pedestrian is in the direction opposite to the repulsion.
            let ahead = -(push[0] * self.direction[0] + push[1] * self.direction[1]);
            let weight = if ahead > sight * length(push) { 1.0 } else { OUT_OF_SIGHT };
            sum = [sum[0] + weight * push[0], sum[1] + weight * push[1]];
        }
        sum
    }

    /// `-grad V`, m/s^2.
    fn push_of(&self, other: &ForcedPedestrian) -> Position {
        let stride = other.stride;
        let from = [0, 1].map(|c| self.position[c] - other.position[c]);
        let near = length(from);
        // |r - s e| >= |r| - s, so that B^2 >= |r| (|r| - s).
        if near * (near - stride) > NEGLIGIBLE * NEGLIGIBLE {
            return [0.0, 0.0];
        }
        let from_next = [0, 1].map(|c| from[c] - stride * other.direction[c]);
        let far = length(from_next);
        let around = near + far;
        let semi_minor = 0.5 * (around * around - stride * stride).max(0.0).sqrt();
        // On the line of its anticipated step the repulsion has no direction.
        if semi_minor > NEGLIGIBLE || semi_minor == 0.0 || near == 0.0 || far == 0.0 {
            return [0.0, 0.0];
        }
        let slope = STRENGTH / REACH * (-semi_minor / REACH).exp() * around / (4.0 * semi_minor);
        [0, 1].map(|c| slope * (from[c] / near + from_next[c] / far))
    }

    fn advance(&mut self, force: Position) {
        let dt = TIME_STEP / SUBSTEPS as f64;
        let wanted = [0, 1].map(|c| self.velocity[c] + dt * force[c]);
        let speed = length(wanted);
        self.velocity = if speed > self.top_speed { wanted.map(|c| c * self.top_speed / speed) } else { wanted };
        self.stride = FORESIGHT * length(self.velocity);
        self.position = [0, 1].map(|c| self.position[c] + dt * self.velocity[c]);
    }
}

fn length(v: Position) -> f64 {
    (v[0] * v[0] + v[1] * v[1]).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::walking;
    use ddl_core::distance;

    fn pedestrians(motions: &[(Position, Position)]) -> Window {
        walking(motions, 8)
    }

    /// Two pedestrians meet, one overtakes, one stands; then a slow one is pushed to its top speed.
    /// `tests/reference/social_force.py` computed the expected positions (first, sixth and last step), with
    /// fourth-order differences of the potential.
    #[test]
    fn pedestrians_walk_as_computed_otherwise() {
        let meets = ([-3.5, 0.0], [0.5, 0.0]);
        let met = ([6.8, 0.3], [-0.4, 0.0]);
        let overtakes = ([-4.55, 0.35], [0.56, 0.0]);
        let stands = ([2.2, -0.9], [0.0, 0.0]);
        let pushed = ([1.0, -2.0], [0.03, 0.06]);
        let others = [([0.6, -4.75], [0.06, 0.4]), ([4.0, 1.2], [-0.3, -0.1])];
        let scenes = [&[meets, met, overtakes, stands][..], &[pushed, others[0], others[1]]];
        let forecasts = scenes.map(|scene| SocialForce.forecast(&pedestrians(scene)).unwrap());
        let expected = [
            [[0.474_506, -0.129_691], [2.147_765, -0.658_875], [4.869_37, -0.085_545]],
            [[3.601_167, 0.300_444], [2.411_451, -0.055_36], [0.049_612, 0.255_175]],
            [[-0.074_799, 0.351_699], [2.540_464, 0.591_208], [5.858_509, 0.937_668]],
            [[2.2, -0.9], [2.2, -0.9], [2.2, -0.9]],
            [[1.292_55, -1.591_609], [1.559_65, -1.544_855], [1.765_47, -1.214_87]],
            [[1.017_195, -1.631_743], [0.485_226, -0.251_914], [-0.045_555, -0.942_513]],
            [[1.603_798, 0.406_865], [1.288_51, 0.075_426], [0.150_498, -0.346_733]],
        ];
        for (i, expected) in expected.into_iter().enumerate() {
            let path = forecasts[i / 4].hypothesis(i % 4, 0);
            for (t, expected) in [0, 5, 11].into_iter().zip(expected) {
                assert!(distance(path[t], expected) < 2e-6, "{i}, {t}: {:?}", path[t]);
            }
        }
    }
}
