//! Motion quantities of a certificate: speed, change of speed, deviation from the straight line, and final distance.

use crate::lyapunov::Violation;
use crate::{attractor::Attractor, motion_bounds::MotionBounds, real::Real};
use nalgebra::SVector;
use serde::{Deserialize, Serialize};

/// Relative tolerance of a bound for rounding.
const ROUNDING: f64 = 1e-9;
/// Tolerance of a position, in rounding errors of its coordinates.
const ROUNDINGS: f64 = 16.0;

/// A quantity of a motion with its bound.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bounded<T> {
    /// The largest value of the motion.
    pub largest: T,
    /// The bound for every metric; it includes the rounding of the positions.
    pub bound: T,
}

impl<T: Real> Bounded<T> {
    fn holds(&self) -> bool {
        self.largest <= self.bound
    }
}

/// Quantities of a motion within [`MotionBounds`], each with its bound, by the theorem of `docs/stability.md`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionEvidence<T> {
    /// Speed of a step (m/s).
    pub speed: Bounded<T>,
    /// Difference between the speeds of successive steps (m/s).
    pub speed_change: Bounded<T>,
    /// Distance from the straight line between start and goal (m).
    pub deviation: Bounded<T>,
    /// Distance from the goal after the last step (m).
    pub distance_left: Bounded<T>,
}

impl<T: Real> MotionEvidence<T> {
    /// The evidence of `path` (metres, finite; the start first), with steps of `dt` seconds within `bounds`.
    pub(super) fn new(path: &[SVector<T, 2>], attractor: &Attractor<T, 2>, bounds: &MotionBounds<T>, dt: T) -> Self {
        let largest_coordinate = path.iter().chain([attractor.goal()]).map(SVector::amax).fold(T::zero(), T::max);
        let off = T::rounded(ROUNDINGS) * T::EPSILON * largest_coordinate;
        let rounded = |bound: T, off: T| bound * T::rounded(1.0 + ROUNDING) + off;
        let (steps, half) = (path.len().saturating_sub(1), T::rounded(0.5));
        let [mut fastest, mut change, mut most_change, mut sideways] = [T::zero(); 4];
        let mut previous = None;
        for (k, pair) in path.windows(2).enumerate() {
            let speed = (pair[1] - pair[0]).norm() / dt;
            let range = bounds.eigenvalues(attractor.distance(&pair[0]), steps - k, dt);
            fastest = fastest.max(speed);
            sideways += (range.largest - range.smallest) * dt * half;
            if let Some((earlier, before)) = previous.replace((speed, range)) {
                change = change.max((earlier - speed).abs());
                most_change = most_change.max((range.largest - before.smallest).max(before.largest - range.smallest));
            }
        }
        let top = bounds.top_speed();
        let off_at_end = off * T::rounded(steps as f64 + 1.0);
        Self {
            speed: Bounded { largest: fastest, bound: rounded(top, off / dt) },
            speed_change: Bounded { largest: change, bound: rounded(most_change.min(top), (off + off) / dt) },
            deviation: Bounded {
                largest: farthest_from_line(path, attractor.goal()),
                bound: rounded(sideways, off_at_end),
            },
            distance_left: Bounded {
                largest: path.last().map_or(T::zero(), |last| attractor.distance(last)),
                bound: rounded(out_of_reach(path, attractor, bounds, dt), off_at_end),
            },
        }
    }

    pub(super) fn check(&self) -> Result<(), Violation> {
        let named = [
            ("speed (m/s)", self.speed),
            ("change of speed between steps (m/s)", self.speed_change),
            ("distance from the straight line (m)", self.deviation),
            ("distance from the goal at the end (m)", self.distance_left),
        ];
        match named.into_iter().find(|(_, bounded)| !bounded.holds()) {
            Some((figure, bounded)) => Err(Violation::OutOfBounds {
                figure: figure.to_owned(),
                value: bounded.largest.as_f64(),
                bound: bounded.bound.as_f64(),
            }),
            None => Ok(()),
        }
    }
}

fn out_of_reach<T: Real>(path: &[SVector<T, 2>], attractor: &Attractor<T, 2>, bounds: &MotionBounds<T>, dt: T) -> T {
    let reach = bounds.top_speed() * dt * T::rounded(path.len().saturating_sub(1) as f64);
    let start = path.first().map_or(T::zero(), |start| attractor.distance(start));
    (start - reach).max(T::zero())
}

/// The largest distance of a position from the line through the first position and the goal. If both are equal, the
/// largest distance from the goal.
fn farthest_from_line<T: Real>(path: &[SVector<T, 2>], goal: &SVector<T, 2>) -> T {
    let Some(start) = path.first() else { return T::zero() };
    let axis = (goal - start).try_normalize(T::zero());
    let off = |p: &SVector<T, 2>| {
        let way = p - start;
        axis.map_or(way.norm(), |axis| way.perp(&axis).abs())
    };
    path.iter().map(off).fold(T::zero(), T::max)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    /// The verdict on a path to (4.8, 0) in 12 steps of 0.4 s, with a speed of at most 2.15 m/s.
    fn said(place: impl Fn(f64) -> [f64; 2]) -> String {
        let path: Vec<Vector2<f64>> = (0..13).map(|t| place(f64::from(t)).into()).collect();
        let attractor = Attractor::new(Vector2::new(4.8, 0.0)).unwrap();
        let bounds = MotionBounds::default();
        let evidence = MotionEvidence::new(&path, &attractor, &bounds, 0.4);
        evidence.check().map_or_else(|violation| violation.to_string(), |()| String::new())
    }

    #[test]
    fn each_figure_that_exceeds_its_bound_is_reported() {
        assert_eq!(said(|t| [0.4 * t, 0.0]), "");
        // A pedestrian that first rests and then walks at a constant speed: once with a jump of 0.9 m, once with 0 m/s
        // before 2.1 m/s.
        let late = |first: f64, leap: f64, pace: f64| {
            said(move |t| [if t < first { 0.0 } else { leap + pace * (t - first) }, 0.0])
        };
        for (said, figure) in [
            (late(1.0, 0.9, 0.354), "speed (m/s)"),
            (late(2.0, 0.84, 0.396), "change of speed"),
            (said(|t| [0.0, 0.84 * t]), "straight line"),
            (said(|t| [0.39 * t, 0.0]), "from the goal at the end"),
        ] {
            assert!(said.contains(figure), "{said}");
        }
    }
}
