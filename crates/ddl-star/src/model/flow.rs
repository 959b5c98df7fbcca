//! The flow of `ddl-dynamics` on tensors, with derivatives: one step of v = -P grad Phi. A test compares the two.

use ddl_dynamics::{MotionBounds, StepTime};
use tch::Tensor;

/// Within this distance (m) a pedestrian counts as at its goal: squares of smaller offsets underflow in f32.
const SMALLEST_NORM: f64 = 1e-18;
/// Added to the square of half the difference of the eigenvalues (m/s), because its root has no derivative at 0.
const SMALLEST_RADIUS_SQUARED: f64 = 1e-14;

/// Constants of the flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FlowConstants {
    /// sigma of P = L L^T + sigma I (eq. 11).
    pub(super) sigma: f64,
    /// Duration of a step in seconds.
    pub(super) time_step: f64,
}

/// The [`MotionBounds`] of a batch.
#[derive(Debug)]
pub(super) struct StepBounds {
    /// Largest speed, m/s; broadcasts to `[.., 1]`.
    pub(super) top_speed: Tensor,
    /// The pedestrians' own velocities, m/s; broadcasts to `[.., 2]`.
    pub(super) velocity: Tensor,
    /// Share of the network's metric in the metric of a step, 0 to 1; broadcasts to `[.., 1]`.
    pub(super) share: Tensor,
    /// Whether the network emits metrics in m/s, as published, instead of departures from the neutral motion.
    pub(super) absolute: bool,
}

/// Next positions under v = -(L L^T + sigma I) u, with u the unit vector away from the goal, by a plain Euler step
/// (paper eq. 7, 9, 11, 12).
///
/// # Shapes
/// `positions` and `goals` broadcast to `[.., 2]`; `factors` `[.., 3]` holds (a, b, c) of L = [[a, 0], [b, c]] ->
/// `[.., 2]`.
///
/// # Numerics
/// P is never formed: P u = L (L^T u) + sigma u, so that sigma is not lost in f32. At the goal u and its derivative are
/// 0: the pedestrian stays, and no value is NaN.
pub(super) fn natural_gradient_step(
    positions: &Tensor,
    goals: &Tensor,
    factors: &Tensor,
    constants: FlowConstants,
) -> Tensor {
    let (_, u) = away(positions, goals);
    let (u1, u2) = (u.narrow(-1, 0, 1), u.narrow(-1, 1, 1));
    let [a, b, c] = entries(factors);
    // w = L^T u
    let w1 = &a * &u1 + &b * &u2;
    let w2 = &c * &u2;
    let pu1 = &a * &w1 + &u1 * constants.sigma;
    let pu2 = &b * &w1 + &c * &w2 + &u2 * constants.sigma;
    positions - Tensor::cat(&[&pu1, &pu2], -1) * constants.time_step
}

/// Next positions under v = -P' u, where P' is the result of [`MotionBounds::shape`] for P = L L^T + sigma I.
///
/// # Shapes
/// As [`natural_gradient_step`].
///
/// # Numerics
/// A clamped eigenvalue has no derivative; the bounds and the neutral motion count as constants.
pub(super) fn bounded_step(
    positions: &Tensor,
    goals: &Tensor,
    factors: &Tensor,
    constants: FlowConstants,
    bounds: &StepBounds,
    time: StepTime<f64>,
) -> Tensor {
    let (distance, u) = away(positions, goals);
    let distance = distance.detach();
    let reach = &distance / time.dt;
    let top = &bounds.top_speed;
    let arriving = (&reach / time.left.max(1) as f64).minimum(top);
    if time.left <= 1 {
        return positions - u * arriving * time.dt;
    }
    let later = top * (time.left - 1) as f64;
    let smallest = (&arriving * MotionBounds::<f64>::MIN_SPEED_RATIO).maximum(&(&reach - later)).minimum(&arriving);
    let largest = (&arriving * MotionBounds::<f64>::MAX_SPEED_RATIO).minimum(&reach).minimum(top).maximum(&arriving);
    let clamp = |eigenvalue: &Tensor| eigenvalue.maximum(&smallest).minimum(&largest);
    let [a, b, c] = entries(factors);
    let neutral = neutral(&u.detach(), &arriving, &smallest, bounds, time).changed(|eigenvalue| clamp(&eigenvalue));
    let emitted = SymmetricTensors {
        xx: a.square() + constants.sigma,
        xy: &a * &b,
        yy: b.square() + c.square() + constants.sigma,
    };
    let given = if bounds.absolute {
        emitted
    } else {
        SymmetricTensors {
            xx: &neutral.xx + (emitted.xx - 1.0) * &arriving,
            xy: &neutral.xy + emitted.xy * &arriving,
            yy: &neutral.yy + (emitted.yy - 1.0) * &arriving,
        }
    };
    let given = given.changed(|eigenvalue| clamp(&eigenvalue));
    let neutral = neutral.times(&u);
    let pu = &neutral + (given.times(&u) - &neutral) * &bounds.share;
    positions - pu * time.dt
}

/// The neutral metric, before its eigenvalues are clamped, with `u` the unit vector away from the goal.
fn neutral(
    u: &Tensor,
    arriving: &Tensor,
    smallest: &Tensor,
    bounds: &StepBounds,
    time: StepTime<f64>,
) -> SymmetricTensors {
    let g = MotionBounds::momentum(time);
    let (cos, sin) = (-u.narrow(-1, 0, 1), -u.narrow(-1, 1, 1));
    let (vx, vy) = (bounds.velocity.narrow(-1, 0, 1), bounds.velocity.narrow(-1, 1, 1));
    let along = arriving * (1.0 - g) + (&vx * &cos + &vy * &sin) * g;
    // At the goal all of these are 0, and the pedestrian stays.
    let a = along.maximum(smallest).clamp_min(f64::from(f32::MIN_POSITIVE));
    let most = &a * MotionBounds::<f64>::MAX_LATERAL_RATIO;
    let b = ((vy * &cos - vx * &sin) * g).maximum(&-&most).minimum(&most);
    let r = &a + (&b / &a) * &b * 2.0;
    let (both, difference) = (&cos * &sin, cos.square() - sin.square());
    SymmetricTensors {
        xx: &a * cos.square() - &b * &both * 2.0 + &r * sin.square(),
        xy: (&a - &r) * &both + &b * difference,
        yy: &a * sin.square() + b * both * 2.0 + r * cos.square(),
    }
}

/// Symmetric 2 x 2 matrices, with each entry `[.., 1]`.
struct SymmetricTensors {
    xx: Tensor,
    xy: Tensor,
    yy: Tensor,
}

impl SymmetricTensors {
    /// The matrix times `u` `[.., 2]`.
    fn times(&self, u: &Tensor) -> Tensor {
        let (u1, u2) = (u.narrow(-1, 0, 1), u.narrow(-1, 1, 1));
        Tensor::cat(&[&self.xx * &u1 + &self.xy * &u2, &self.xy * u1 + &self.yy * u2], -1)
    }

    /// The matrix with transformed eigenvalues.
    fn changed(&self, changed: impl Fn(Tensor) -> Tensor) -> Self {
        let (mean, half) = ((&self.xx + &self.yy) * 0.5, (&self.xx - &self.yy) * 0.5);
        let radius = (half.square() + self.xy.square() + SMALLEST_RADIUS_SQUARED).sqrt();
        let (first, second) = (changed(&mean + &radius), changed(&mean - &radius));
        let (middle, stretch) = ((&first + &second) * 0.5, (first - second) * 0.5 / radius);
        Self { xx: &middle + &half * &stretch, xy: &self.xy * &stretch, yy: middle - half * stretch }
    }
}

/// Distance to the goal (m) `[.., 1]` and the unit vector away from it `[.., 2]`.
fn away(positions: &Tensor, goals: &Tensor) -> (Tensor, Tensor) {
    let offset = positions - goals;
    let distance = offset.norm_scalaropt_dim(2, [-1i64].as_slice(), true);
    // At the goal, divide by infinity: u and its derivative are then 0. A small divisor would make the derivative huge,
    // and the derivative of several steps at the goal NaN.
    let at_goal = distance.lt(SMALLEST_NORM);
    let u = offset / distance.masked_fill(&at_goal, f64::INFINITY);
    (distance, u)
}

/// a, b and c, each `[.., 1]`.
fn entries(factors: &Tensor) -> [Tensor; 3] {
    [0, 1, 2].map(|i| factors.narrow(-1, i, 1))
}

#[cfg(test)]
mod tests;
