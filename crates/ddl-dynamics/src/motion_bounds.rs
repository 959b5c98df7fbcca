//! Bounds of a motion that has to arrive in time, and the neutral motion within them.

use crate::{metric::CholeskyMetric, polar::polar, real::Real, spectrum::EigenvalueRange};
use nalgebra::{Vector2, Vector3};

/// Bounds within which a metric shapes the path of a pedestrian that arrives at its goal in time, and the neutral
/// motion that applies without a metric.
///
/// With the distance `d` to the goal and `n` remaining steps of `dt` seconds, the *arriving speed* is `s = d / (n dt)`:
/// at this constant speed a straight path ends on the goal. The eigenvalues of `P` are kept within
///
/// ```text
/// m = max(MIN_SPEED_RATIO s, n s - (n - 1) V)        M = min(MAX_SPEED_RATIO s, n s, V)        m = M = s  if n = 1
/// ```
///
/// with `V` the [top speed](Self::top_speed). The *neutral* metric `N` within these bounds leads from the pedestrian's
/// own velocity to the arriving velocity. A step is shaped by `N + share (P - N)`, brought within the bounds. Here `P =
/// N + s (Q - I)` for a given metric `Q`, or `P = Q` for an [absolute](Self::absolute) one.
///
/// # What is guaranteed
/// If `d <= n dt V` at the start, then for every sequence of metrics no step is faster than `V`, none of the remaining
/// steps passes the goal, and the last one ends on it. `docs/stability.md` has the formulas and the proof.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionBounds<T: Real> {
    top_speed: T,
    velocity: Vector2<T>,
    share: T,
    absolute: bool,
}

/// Time of a step within the motion: steps made before it, steps remaining, and their duration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepTime<T> {
    /// Steps made since the last observation of the pedestrian.
    pub done: usize,
    /// Steps until the pedestrian should be at its goal, this one included.
    pub left: usize,
    /// Duration of a step (seconds).
    pub dt: T,
}

impl<T: Real> Default for MotionBounds<T> {
    /// The bounds of a pedestrian without observed motion, with only the metric (`share` 1).
    fn default() -> Self {
        Self {
            top_speed: Self::top_speed_after(T::zero()),
            velocity: Vector2::zeros(),
            share: T::one(),
            absolute: false,
        }
    }
}

impl<T: Real> MotionBounds<T> {
    /// Smallest eigenvalue in arriving speeds (no unit), unless the goal would become unreachable.
    pub const MIN_SPEED_RATIO: f64 = 0.25;
    /// The largest eigenvalue in arriving speeds (no unit).
    pub const MAX_SPEED_RATIO: f64 = 2.0;
    /// Top speed of a pedestrian without observed motion (m/s).
    pub const LEAST_TOP_SPEED: f64 = 2.15;
    /// Top speed per m/s of the fastest observed step (no unit) ...
    pub const TOP_SPEED_FACTOR: f64 = 1.3;
    /// ... and the constant added to it (m/s).
    pub const SPEED_MARGIN: f64 = 0.45;
    /// Weight of the pedestrian's own velocity in the neutral motion at the start (no unit).
    const MOMENTUM: f64 = 0.75;
    /// Time in which that weight falls by a factor e (s).
    const RELAXATION: f64 = 1.0;
    /// Largest lateral component of the neutral motion, relative to its component towards the goal (no unit).
    pub const MAX_LATERAL_RATIO: f64 = 2.0;

    /// The top speed (m/s) of a pedestrian whose fastest observed step had the speed `fastest` (m/s): the larger of
    /// 2.15 m/s and `1.3 fastest + 0.45 m/s`.
    pub fn top_speed_after(fastest: T) -> T {
        let faster = fastest * T::rounded(Self::TOP_SPEED_FACTOR) + T::rounded(Self::SPEED_MARGIN);
        faster.max(T::rounded(Self::LEAST_TOP_SPEED))
    }

    /// The weight of the own velocity in the neutral motion, in the middle of a step (no unit).
    pub fn momentum(time: StepTime<T>) -> f64 {
        let middle = (time.done as f64 + 0.5) * time.dt.as_f64();
        Self::MOMENTUM * (-middle / Self::RELAXATION).exp()
    }

    /// Bounds with the top speed `V` (m/s, positive), the pedestrian's own velocity `v0` (m/s), and the `share` of the
    /// metric, from 0 to 1; the rest is neutral. `None` if one is out of range or not finite.
    pub fn new(top_speed: T, velocity: Vector2<T>, share: T) -> Option<Self> {
        let valid = top_speed.is_finite()
            && top_speed > T::zero()
            && velocity.iter().all(nalgebra::ComplexField::is_finite)
            && share >= T::zero()
            && share <= T::one();
        valid.then_some(Self { top_speed, velocity, share, absolute: false })
    }

    /// The same bounds for metrics in m/s, as published, instead of relative to the neutral motion in arriving speeds.
    #[must_use]
    pub fn absolute(self) -> Self {
        Self { absolute: true, ..self }
    }

    /// The largest speed of any step (m/s).
    pub fn top_speed(&self) -> T {
        self.top_speed
    }

    /// The pedestrian's own velocity `v0` (m/s).
    pub fn velocity(&self) -> Vector2<T> {
        self.velocity
    }

    /// The weight of the metric against the neutral motion (no unit).
    pub fn share(&self) -> T {
        self.share
    }

    /// The speed at which a pedestrian `distance` metres from its goal arrives in `left` steps of `dt` seconds (m/s),
    /// at most the [top speed](Self::top_speed).
    fn arriving_speed(&self, distance: T, left: usize, dt: T) -> T {
        let steps = T::rounded(left.max(1) as f64);
        // Positive, so that it is a valid eigenvalue also at the goal.
        (distance / (steps * dt)).min(self.top_speed).max(T::MIN_POSITIVE)
    }

    /// The range of the eigenvalues (m/s), `distance` metres from the goal with `left` remaining steps of `dt` seconds,
    /// this one included. If the goal is out of reach, both ends are the top speed.
    pub fn eigenvalues(&self, distance: T, left: usize, dt: T) -> EigenvalueRange<T> {
        let s = self.arriving_speed(distance, left, dt);
        if left <= 1 {
            return EigenvalueRange { smallest: s, largest: s };
        }
        let reach = distance / dt;
        let later = T::rounded((left - 1) as f64) * self.top_speed;
        EigenvalueRange {
            smallest: (T::rounded(Self::MIN_SPEED_RATIO) * s).max(reach - later).min(s),
            largest: (T::rounded(Self::MAX_SPEED_RATIO) * s).min(reach).min(self.top_speed).max(s),
        }
    }

    /// The metric that shapes a step, from the given `metric` and the displacement `towards` the goal (m). Its smallest
    /// eigenvalue is exact and positive, also if `metric` is singular.
    pub fn shape(
        &self,
        metric: &CholeskyMetric<T, 2>,
        towards: &Vector2<T>,
        time: StepTime<T>,
    ) -> CholeskyMetric<T, 2> {
        let (distance, direction) = polar(towards);
        let range = self.eigenvalues(distance, time.left, time.dt);
        let s = self.arriving_speed(distance, time.left, time.dt);
        let neutral = within(&self.neutral(s, &direction, &range, time), &range);
        let given = if self.absolute {
            entries(metric)
        } else {
            let identity = Vector3::new(T::one(), T::zero(), T::one());
            neutral + (entries(metric) - identity) * s
        };
        let given = within(&given, &range);
        into_metric(&(neutral + (given - neutral) * self.share), &range)
    }

    /// `N` before its eigenvalues are brought within the bounds. Of all matrices with this velocity it has the smallest
    /// condition number.
    fn neutral(&self, s: T, direction: &Vector2<T>, range: &EigenvalueRange<T>, time: StepTime<T>) -> Vector3<T> {
        let g = T::rounded(Self::momentum(time));
        let [cos, sin] = [direction.x, direction.y];
        let along = (T::one() - g) * s + g * self.velocity.dot(direction);
        let a = along.max(range.smallest);
        let across = g * (cos * self.velocity.y - sin * self.velocity.x);
        let most = a * T::rounded(Self::MAX_LATERAL_RATIO);
        let b = across.max(-most).min(most);
        let r = a + (b / a) * b * T::rounded(2.0);
        Vector3::new(
            a * cos * cos - (b + b) * cos * sin + r * sin * sin,
            (a - r) * cos * sin + b * (cos * cos - sin * sin),
            a * sin * sin + (b + b) * cos * sin + r * cos * cos,
        )
    }
}

fn entries<T: Real>(metric: &CholeskyMetric<T, 2>) -> Vector3<T> {
    let p = metric.to_matrix();
    Vector3::new(p.m11, p.m12, p.m22)
}

/// The eigenvalues, brought within the range, the larger one first; and the cosine and sine of twice the angle of its
/// eigenvector.
fn axes<T: Real>(p: &Vector3<T>, range: &EigenvalueRange<T>) -> ([T; 2], [T; 2]) {
    let two = T::rounded(2.0);
    let (mean, half) = (p.x / two + p.z / two, p.x / two - p.z / two);
    let (radius, double) = polar(&Vector2::new(half, p.y));
    let clamped = [mean + radius, mean - radius].map(|l| l.max(range.smallest).min(range.largest));
    (clamped, [double.x, double.y])
}

fn within<T: Real>(p: &Vector3<T>, range: &EigenvalueRange<T>) -> Vector3<T> {
    let ([first, second], [cos, sin]) = axes(p, range);
    let two = T::rounded(2.0);
    let (middle, half) = (first / two + second / two, first / two - second / two);
    Vector3::new(middle + half * cos, half * sin, middle - half * cos)
}

fn into_metric<T: Real>(p: &Vector3<T>, range: &EigenvalueRange<T>) -> CholeskyMetric<T, 2> {
    let ([first, second], [cos, sin]) = axes(p, range);
    // Half of the double angle: (1 + cos, sin) has its direction, and so does (sin, 1 - cos).
    let axis = if cos >= T::zero() { Vector2::new(T::one() + cos, sin) } else { Vector2::new(sin, T::one() - cos) };
    let (_, axis) = polar(&axis);
    let stretch = (first - second).max(T::zero()).sqrt();
    CholeskyMetric::of_axis(axis * stretch, second)
}
