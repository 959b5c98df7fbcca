//! A pedestrian's own frame. Its first axis points from the last observed position to the goal, and its unit of length
//! depends on the pedestrian's speed. So a track trains all directions, and the inputs of a runner are like those of a
//! fast walk.
//!
//! The unit is `(1 + (v / 2 m/s)^4)^(1/4)` metres for the mean observed speed `v`: about 1 m up to walking speed, and
//! about v / (2 m/s) metres far above it.

use ddl_core::motion::FAST_WALK;
use ddl_core::{Position, mean_speed};

/// Closer to its goal than this (metres), a pedestrian's frame has the axes of the world.
const SMALLEST_DISTANCE: f64 = 1e-6;
/// Lower bound of the squares of pivots, in m/s.
pub(super) const SMALLEST_PIVOT: f32 = 1e-12;

/// The frame of one pedestrian in one hypothesis: cosine and sine of its first axis, and its unit of length (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OwnFrame {
    cos: f32,
    sin: f32,
    unit: f32,
}

impl OwnFrame {
    /// The frame of a pedestrian last observed at `last` with the goal `goal` (m) and this unit (m).
    pub(super) fn new(last: Position, goal: Position, unit: f64) -> Self {
        let [x, y] = [goal[0] - last[0], goal[1] - last[1]];
        let distance = x.hypot(y);
        let [cos, sin] = if distance < SMALLEST_DISTANCE { [1.0, 0.0] } else { [x / distance, y / distance] };
        let [cos, sin, unit] = [cos, sin, unit].map(|x| x as f32);
        Self { cos, sin, unit }
    }

    pub(super) fn of_world(self, [x, y]: [f32; 2]) -> [f32; 2] {
        let Self { cos, sin, unit } = self;
        [(cos * x + sin * y) / unit, (cos * y - sin * x) / unit]
    }

    pub(super) fn to_world(self, [x, y]: [f32; 2]) -> [f32; 2] {
        let Self { cos, sin, unit } = self;
        [(cos * x - sin * y) * unit, (cos * y + sin * x) * unit]
    }

    /// The lower-triangular factor of the same metric in the frame of the world: L' L'^T = R^T L L^T R.
    ///
    /// The first row of R^T L is zero if L is singular with its null space along the x axis of the world. Then the
    /// square of the first pivot is raised to 1e-12 m/s, and the second row is lost: the pedestrian stands still, and P
    /// is still positive definite.
    pub(super) fn factor_to_world(self, [a, b, c]: [f32; 3]) -> [f32; 3] {
        let Self { cos, sin, .. } = self;
        let (x1, x2) = (cos * a - sin * b, -(sin * c));
        let (y1, y2) = (sin * a + cos * b, cos * c);
        let first = (x1 * x1 + x2 * x2).max(SMALLEST_PIVOT).sqrt();
        [first, (x1 * y1 + x2 * y2) / first, a * c / first]
    }
}

/// The unit of length of a pedestrian's own frame (m), from its observed positions (m), `time_step` seconds apart. 1
/// for fewer than two positions.
///
/// # Examples
/// ```
/// let track = |speed: f64| (0..8).map(|t| [0.4 * speed * f64::from(t), 0.0]).collect::<Vec<_>>();
/// assert!((ddl_network::length_unit(&track(1.0), 0.4) - 1.0).abs() < 0.02); // walking
/// assert!((ddl_network::length_unit(&track(6.0), 0.4) - 3.0).abs() < 0.02); // running
/// ```
pub fn length_unit(observed: &[Position], time_step: f64) -> f64 {
    let relative = mean_speed(observed, time_step) / FAST_WALK;
    // The division by the larger of the two prevents an overflow of the fourth power.
    let larger = relative.max(1.0);
    larger * (larger.powi(-4) + (relative / larger).powi(4)).powf(0.25)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn metric_times([a, b, c]: [f64; 3], [x, y]: [f64; 2]) -> [f64; 2] {
        let (w1, w2) = (a * x + b * y, c * y);
        [a * w1, b * w1 + c * w2]
    }

    proptest! {
        #[test]
        fn the_metric_turns_with_the_frame(
            angle in 0.0..std::f64::consts::TAU,
            factor in [0.2..3.0f64, -2.0..2.0f64, 0.2..3.0f64],
            u in [-2.0..2.0f64, -2.0..2.0f64],
        ) {
            let (sin, cos) = angle.sin_cos();
            let frame = OwnFrame::new([1.0, 2.0], [1.0 + 3.0 * cos, 2.0 + 3.0 * sin], 1.0);
            let turned = frame.factor_to_world(factor.map(|x| x as f32)).map(f64::from);
            let turned_back = [cos * u[0] + sin * u[1], cos * u[1] - sin * u[0]];
            let [x, y] = metric_times(factor, turned_back);
            let expected = [cos * x - sin * y, cos * y + sin * x];
            let product = metric_times(turned, u);
            for axis in [0, 1] {
                prop_assert!((product[axis] - expected[axis]).abs() < 1e-4);
                let back = frame.to_world(frame.of_world(u.map(|x| x as f32)))[axis];
                prop_assert!((f64::from(back) - u[axis]).abs() < 1e-5);
            }
        }

        #[test]
        fn speeds_in_own_units_are_at_most_a_fast_walk(
            track in prop::collection::vec([-3.0..3.0f64, -3.0..3.0f64], 8),
            scale in -6.0..6.0f64,
        ) {
            let track: Vec<Position> = track.iter().map(|p| p.map(|x| x * 10f64.powf(scale))).collect();
            let unit = length_unit(&track, 0.4);
            let lengths = track.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1]));
            let speed = lengths.sum::<f64>() / 7.0 / 0.4;
            prop_assert!(unit >= 1.0 && speed / unit <= FAST_WALK * (1.0 + 1e-12));
        }
    }

    #[test]
    fn the_first_axis_points_to_the_goal_or_along_x_if_it_is_reached() {
        let frame = OwnFrame::new([1.0, 2.0], [1.0, 6.0], 2.0);
        let same = |result: [f32; 2], expected: [f32; 2]| {
            assert_eq!(result.map(f32::to_bits), expected.map(f32::to_bits));
        };
        same(frame.of_world([0.0, 4.0]), [2.0, 0.0]);
        same(frame.to_world([1.0, 1.0]), [-2.0, 2.0]);
        let there = OwnFrame::new([5.0, 5.0], [5.0, 5.0], 1.0);
        same(there.of_world([0.3, -0.7]), [0.3, -0.7]);
    }
}
