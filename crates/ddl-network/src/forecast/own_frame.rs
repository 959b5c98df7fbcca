//! A pedestrian's own frame: the first axis points from where it was last observed to its goal, and lengths are in
//! its own unit. So one walk teaches all directions, and a runner looks like a fast pedestrian.
//!
//! The unit is `(1 + (v / 2 m/s)^4)^(1/4)` metres for the mean observed speed `v`: a metre up to walking speed, v / (2
//! m/s) metres far above it.

use ddl_data::Position;

/// Nearer to its goal than this (metres) a pedestrian has the axes of the world.
const SMALLEST_DISTANCE: f64 = 1e-6;
/// Speed (m/s) around which the unit begins to grow: the fastest that training recordings hold many examples of.
const FAST_WALK: f64 = 2.0;
/// Squares of pivots below this count as this, in m/s.
const SMALLEST_PIVOT: f32 = 1e-12;

/// The frame of one pedestrian in one hypothesis: its first axis, as cosine and sine, and its unit of length (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OwnFrame {
    cos: f32,
    sin: f32,
    unit: f32,
}

impl OwnFrame {
    /// Of who was last observed at `last` and goes to `goal` (m), in this unit.
    pub(super) fn new(last: Position, goal: Position, unit: f64) -> Self {
        let [x, y] = [goal[0] - last[0], goal[1] - last[1]];
        let distance = x.hypot(y);
        let [cos, sin] = if distance < SMALLEST_DISTANCE {
            [1.0, 0.0]
        } else {
            [x / distance, y / distance]
        };
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

    /// The lower-triangular factor of the same metric in the world: L' L'^T = R^T L L^T R.
    /// Where the first row of R^T L vanishes (L singular, its null space along the world's x axis) the square of the first pivot is
    /// raised to 1e-12 m/s and what the second row is worth is lost: the pedestrian stands, and P is still positive definite.
    pub(super) fn factor_to_world(self, [a, b, c]: [f32; 3]) -> [f32; 3] {
        let Self { cos, sin, .. } = self;
        let (x1, x2) = (cos * a - sin * b, -(sin * c));
        let (y1, y2) = (sin * a + cos * b, cos * c);
        let first = (x1 * x1 + x2 * x2).max(SMALLEST_PIVOT).sqrt();
        [first, (x1 * y1 + x2 * y2) / first, a * c / first]
    }
}

/// The unit of a pedestrian (m) from its observed positions (m), `time_step` seconds apart; 1 for fewer than two.
///
/// # Examples
/// ```
/// let at = |speed: f64| (0..8).map(|t| [0.4 * speed * f64::from(t), 0.0]).collect::<Vec<_>>();
/// assert!((ddl_network::motion_unit(&at(1.0), 0.4) - 1.0).abs() < 0.02); // walking
/// assert!((ddl_network::motion_unit(&at(6.0), 0.4) - 3.0).abs() < 0.02); // running
/// ```
pub fn motion_unit(observed: &[Position], time_step: f64) -> f64 {
    let steps = observed.len().saturating_sub(1).max(1) as f64;
    let way: f64 = observed
        .windows(2)
        .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]))
        .sum();
    let relative = way / (steps * time_step * FAST_WALK);
    // Divided by the larger of the two first: the fourth power of a large number overflows.
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
            let own = [cos * u[0] + sin * u[1], cos * u[1] - sin * u[0]];
            let [x, y] = metric_times(factor, own);
            let expected = [cos * x - sin * y, cos * y + sin * x];
            let found = metric_times(turned, u);
            for axis in [0, 1] {
                prop_assert!((found[axis] - expected[axis]).abs() < 1e-4);
                let back = frame.to_world(frame.of_world(u.map(|x| x as f32)))[axis];
                prop_assert!((f64::from(back) - u[axis]).abs() < 1e-5);
            }
        }

        #[test]
        fn nobody_is_faster_than_a_fast_walk_in_its_own_units(
            track in prop::collection::vec([-3.0..3.0f64, -3.0..3.0f64], 8),
            scale in -6.0..6.0f64,
        ) {
            let track: Vec<Position> = track.iter().map(|p| p.map(|x| x * 10f64.powf(scale))).collect();
            let unit = motion_unit(&track, 0.4);
            let lengths = track.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1]));
            let speed = lengths.sum::<f64>() / 7.0 / 0.4;
            prop_assert!(unit >= 1.0 && speed / unit <= FAST_WALK * (1.0 + 1e-12));
        }
    }

    #[test]
    fn the_goal_lies_ahead_in_units_and_whoever_is_there_looks_along_x() {
        let frame = OwnFrame::new([1.0, 2.0], [1.0, 6.0], 2.0);
        let same = |found: [f32; 2], expected: [f32; 2]| {
            assert_eq!(found.map(f32::to_bits), expected.map(f32::to_bits));
        };
        same(frame.of_world([0.0, 4.0]), [2.0, 0.0]);
        same(frame.to_world([1.0, 1.0]), [-2.0, 2.0]);
        let there = OwnFrame::new([5.0, 5.0], [5.0, 5.0], 1.0);
        same(there.of_world([0.3, -0.7]), [0.3, -0.7]);
    }
}
