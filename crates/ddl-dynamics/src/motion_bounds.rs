//! Bounds on a motion that has to arrive in time, and the neutral motion within them.

use nalgebra::{Vector2, Vector3};

use crate::{metric::CholeskyMetric, polar::polar, real::Real, spectrum::EigenvalueRange};

/// The bounds between which a metric shapes the way of a pedestrian that arrives at its goal in time, and the motion
/// that is made where nothing shapes it.
///
/// With the distance `d` to the goal and `n` steps of `dt` seconds left, the *arriving speed* is `s = d / (n dt)`: at
/// this constant speed the straight walk ends on the goal. The eigenvalues of `P` are kept within
///
/// ```text
/// m = max(SLOWEST s, n s - (n - 1) V)        M = min(FASTEST s, n s, V)        m = M = s  if n = 1
/// ```
///
/// with `V` the [top speed](Self::top_speed). The *neutral* metric `N` within these bounds leads from the pedestrian's own
/// velocity over to the arriving one. What shapes a step is `N + share (P - N)`, with `P = N + s (Q - I)` of a given metric
/// `Q`, or `P = Q` of an [absolute](Self::absolute) one, brought within the bounds.
///
/// # What is guaranteed
/// If `d <= n dt V` at the start, then for every sequence of metrics: no step is faster than `V`, no step
/// of the remaining ones passes the goal, and the last one ends on it. `docs/stability.md` has the formulas and the proof.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionBounds<T: Real> {
    top_speed: T,
    velocity: Vector2<T>,
    share: T,
    absolute: bool,
}

/// When a step is made: after how many, with how many left, this one included, and how long each takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepTime<T> {
    /// Steps made since the pedestrian was last observed.
    pub done: usize,
    /// Steps until it should be at its goal, this one included.
    pub left: usize,
    /// Seconds a step.
    pub dt: T,
}

impl<T: Real> Default for MotionBounds<T> {
    /// Those of a pedestrian that was not seen to move, whose metric is taken whole.
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
    /// The smallest eigenvalue in arriving speeds (no unit), unless the goal would come out of reach.
    pub const SLOWEST: f64 = 0.25;
    /// The largest eigenvalue in arriving speeds (no unit).
    pub const FASTEST: f64 = 2.0;
    /// The top speed of a pedestrian that was not seen to move (m/s).
    pub const LEAST_TOP_SPEED: f64 = 2.15;
    /// Top speed for each m/s of the fastest observed step (no unit).
    pub const SPEEDING_UP: f64 = 1.3;
    /// Top speed beyond that (m/s).
    pub const SPEED_MARGIN: f64 = 0.45;
    /// Share of the own velocity in the neutral motion at the start (no unit).
    pub const MOMENTUM: f64 = 0.75;
    /// Time in which that share falls to its e-th part (s).
    pub const RELAXATION: f64 = 1.0;
    /// The neutral motion's largest component across the way to the goal, in components along it (no unit).
    pub const STEEPEST: f64 = 2.0;

    /// The top speed (m/s) of a pedestrian whose fastest observed step was made at `fastest` m/s:
    /// 2.15 m/s, or 1.3 times that speed and 0.45 m/s, whichever is more.
    pub fn top_speed_after(fastest: T) -> T {
        let faster = fastest * T::rounded(Self::SPEEDING_UP) + T::rounded(Self::SPEED_MARGIN);
        faster.max(T::rounded(Self::LEAST_TOP_SPEED))
    }

    /// The share of the own velocity in the neutral motion, in the middle of a step (no unit).
    pub fn momentum(time: StepTime<T>) -> f64 {
        let middle = (time.done as f64 + 0.5) * time.dt.as_f64();
        Self::MOMENTUM * (-middle / Self::RELAXATION).exp()
    }

    /// Bounds with the top speed `V` (m/s, positive), the pedestrian's own velocity `v0` (m/s), and the `share` (0 to
    /// 1) of the metric in what shapes a step; `None` when one is out of range or not finite.
    pub fn new(top_speed: T, velocity: Vector2<T>, share: T) -> Option<Self> {
        let valid = top_speed.is_finite()
            && top_speed > T::zero()
            && velocity.iter().all(nalgebra::ComplexField::is_finite)
            && share >= T::zero()
            && share <= T::one();
        valid.then_some(Self {
            top_speed,
            velocity,
            share,
            absolute: false,
        })
    }

    /// The same bounds for metrics in m/s, as published, and not in arriving speeds about the neutral motion.
    #[must_use]
    pub fn absolute(self) -> Self {
        Self {
            absolute: true,
            ..self
        }
    }

    /// The largest speed of any step (m/s).
    pub fn top_speed(&self) -> T {
        self.top_speed
    }

    /// The pedestrian's own velocity `v0` (m/s).
    pub fn velocity(&self) -> Vector2<T> {
        self.velocity
    }

    /// The share of the metric in what shapes a step; the rest is neutral (no unit).
    pub fn share(&self) -> T {
        self.share
    }

    /// The speed at which a pedestrian `distance` metres from its goal arrives in `left` steps of `dt`
    /// seconds (m/s), never more than the [top speed](Self::top_speed).
    pub fn arriving_speed(&self, distance: T, left: usize, dt: T) -> T {
        let steps = T::rounded(left.max(1) as f64);
        // Positive, so that a metric with this eigenvalue is one, also at the goal.
        (distance / (steps * dt))
            .min(self.top_speed)
            .max(T::MIN_POSITIVE)
    }

    /// The range of the eigenvalues `distance` metres from the goal with `left` steps of `dt` seconds
    /// left, this one included (m/s). Where the goal is out of reach both ends are the top speed.
    pub fn eigenvalues(&self, distance: T, left: usize, dt: T) -> EigenvalueRange<T> {
        let s = self.arriving_speed(distance, left, dt);
        if left <= 1 {
            return EigenvalueRange {
                smallest: s,
                largest: s,
            };
        }
        let reach = distance / dt;
        let later = T::rounded((left - 1) as f64) * self.top_speed;
        EigenvalueRange {
            smallest: (T::rounded(Self::SLOWEST) * s).max(reach - later).min(s),
            largest: (T::rounded(Self::FASTEST) * s)
                .min(reach)
                .min(self.top_speed)
                .max(s),
        }
    }

    /// What shapes a step of a pedestrian for whom `metric` was given, with the way to the goal `towards` (m). Its
    /// smallest eigenvalue is exact, and positive, also where `metric` is singular.
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

    /// `N`, before its eigenvalues are brought within the bounds: of all matrices with this flow the one of the
    /// least condition number.
    fn neutral(
        &self,
        s: T,
        direction: &Vector2<T>,
        range: &EigenvalueRange<T>,
        time: StepTime<T>,
    ) -> Vector3<T> {
        let g = T::rounded(Self::momentum(time));
        let [cos, sin] = [direction.x, direction.y];
        let along = (T::one() - g) * s + g * self.velocity.dot(direction);
        let a = along.max(range.smallest);
        let across = g * (cos * self.velocity.y - sin * self.velocity.x);
        let most = a * T::rounded(Self::STEEPEST);
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

/// Mean of the eigenvalues, half their difference, and the cosine and sine of twice the angle of the larger one's
/// eigenvector.
fn axes<T: Real>(p: &Vector3<T>) -> (T, T, [T; 2]) {
    let two = T::rounded(2.0);
    let (mean, half) = (p.x / two + p.z / two, p.x / two - p.z / two);
    let (radius, double) = polar(&Vector2::new(half, p.y));
    (mean, radius, [double.x, double.y])
}

fn within<T: Real>(p: &Vector3<T>, range: &EigenvalueRange<T>) -> Vector3<T> {
    let (mean, radius, [cos, sin]) = axes(p);
    let (first, second) = clamped(mean, radius, range);
    let two = T::rounded(2.0);
    let (middle, half) = (first / two + second / two, first / two - second / two);
    Vector3::new(middle + half * cos, half * sin, middle - half * cos)
}

fn into_metric<T: Real>(p: &Vector3<T>, range: &EigenvalueRange<T>) -> CholeskyMetric<T, 2> {
    let (mean, radius, [cos, sin]) = axes(p);
    let (first, second) = clamped(mean, radius, range);
    // Half of the double angle: (1 + cos, sin) has its direction, and so has (sin, 1 - cos).
    let axis = if cos >= T::zero() {
        Vector2::new(T::one() + cos, sin)
    } else {
        Vector2::new(sin, T::one() - cos)
    };
    let (_, axis) = polar(&axis);
    let stretch = (first - second).max(T::zero()).sqrt();
    CholeskyMetric::of_axis(axis * stretch, second)
}

/// Both eigenvalues within the range, the larger one first.
fn clamped<T: Real>(mean: T, radius: T, range: &EigenvalueRange<T>) -> (T, T) {
    let clamp = |l: T| l.max(range.smallest).min(range.largest);
    (clamp(mean + radius), clamp(mean - radius))
}
