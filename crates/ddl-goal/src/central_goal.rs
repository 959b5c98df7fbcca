//! The one goal for who may have only one.

use crate::goal_set::GoalSet;

/// Steps from the last observed frame to the end of the forecast.
const STEPS_AHEAD: f64 = 12.0;
/// How far the central goal of an exactly observed walker lies on the way from the median of its goals to where its last step leads.
const TRUST: f64 = 0.7;
/// How far the central goal of a walker whose steps tremble lies on the way to where the mean observed velocity leads.
const STEADINESS: f64 = 0.25;
/// Mean change of the observed step (m) at which the last step is trusted by a factor e less.
const JITTER: f64 = 0.06;

impl GoalSet {
    /// The one goal for who may have only one: the [`median`](Self::median) of the goals, drawn towards where the observed velocity
    /// leads: that of the last step where steps are even, the mean of all steps where they tremble.
    ///
    /// With m the median, p the last observed position, s the last step, a the mean of the steps, w the mean length of the second differences of
    /// the observed positions and e = exp(-(w / 6 cm)²), it is m + 0.7 e (p + 12 s - m) + 0.25 (1 - e) (p + 12 a - m). A last step is exact where steps
    /// hardly change, and says more of where a pedestrian is in 4.8 s than any pedestrian like it; where annotation or detection trembles it says
    /// nothing, and the mean of all steps says a little. The constants were chosen with whole places left out (`docs/accuracy.md`).
    ///
    /// # Shapes
    /// `observed`: the observed positions (m), the last one last. Fewer than three show no tremble: the median stands alone.
    pub fn central(&self, observed: &[[f64; 2]]) -> [f64; 2] {
        let median = self.median();
        let &[_, .., before, last] = observed else {
            return median;
        };
        let even = evenness(observed);
        let steps = (observed.len() - 1) as f64;
        let first = observed[0];
        std::array::from_fn(|axis| {
            let ahead = last[axis] + STEPS_AHEAD * (last[axis] - before[axis]);
            let steady = last[axis] + STEPS_AHEAD * (last[axis] - first[axis]) / steps;
            median[axis]
                + TRUST * even * (ahead - median[axis])
                + STEADINESS * (1.0 - even) * (steady - median[axis])
        })
    }

    /// The set of the [`central`](Self::central) goal alone, of weight 1; `observed` are the walker's positions (m), as there.
    #[must_use]
    pub fn only_central(&self, observed: &[[f64; 2]]) -> Self {
        let experts = self.experts().to_vec();
        Self::new(vec![self.central(observed)], vec![1.0], experts)
    }
}

/// e.
fn evenness(observed: &[[f64; 2]]) -> f64 {
    let changes = observed.array_windows::<3>().map(|[a, b, c]| {
        let change = |axis: usize| c[axis] - 2.0 * b[axis] + a[axis];
        change(0).hypot(change(1))
    });
    let count = changes.len();
    if count == 0 {
        return 0.0;
    }
    let mean = changes.sum::<f64>() / count as f64;
    (-(mean / JITTER).powi(2)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn set(goals: &[[f64; 2]]) -> GoalSet {
        let weights = vec![1.0 / goals.len() as f64; goals.len()];
        GoalSet::new(goals.to_vec(), weights, Vec::new())
    }

    /// 8 positions, one step of (0.5, 0) m a frame, every other one off by `off` to the side.
    fn walk(off: f64) -> Vec<[f64; 2]> {
        (0..8_u32)
            .map(|t| {
                let side = if t.is_multiple_of(2) { off } else { 0.0 };
                [0.5 * f64::from(t), side]
            })
            .collect()
    }

    /// Worked by hand: the last step leads from (3.5, 0) to (9.5, 0), seven tenths of the way from the only goal.
    #[test]
    fn who_walks_evenly_is_believed() {
        let [x, y] = set(&[[3.5, 5.0]]).central(&walk(0.0));
        assert!(
            (x - 7.7).abs() < 1e-12 && (y - 1.5).abs() < 1e-12,
            "{x} {y}"
        );
    }

    #[test]
    fn who_trembles_is_not() {
        // second differences of 40 cm; the mean velocity leads from (3.5, 0) to (9.5, -0.2 * 12 / 7)
        let goal = [3.5, 5.0];
        let [x, y] = set(&[goal]).central(&walk(0.2));
        let steady = [9.5, -2.4 / 7.0];
        assert!(
            (x - (3.5 + 0.25 * 6.0)).abs() < 1e-9
                && (y - (5.0 + 0.25 * (steady[1] - 5.0))).abs() < 1e-9
        );
        // of 6 cm: 0.7 / e and 0.25 (1 - 1 / e) of the way along x
        let [x, _] = set(&[goal]).central(&walk(0.03));
        let even = 1.0 / std::f64::consts::E;
        assert!(
            (x - (3.5 + 6.0 * (0.7 * even + 0.25 * (1.0 - even)))).abs() < 1e-9,
            "{x}"
        );
    }

    #[test]
    fn too_short_an_observation_leaves_the_median() {
        let set = set(&[[1.0, 2.0]]);
        for observed in [&[][..], &[[0.0, 0.0]], &[[0.0, 0.0], [1.0, 0.0]]] {
            assert_eq!(
                set.central(observed).map(f64::to_bits),
                [1.0_f64, 2.0].map(f64::to_bits)
            );
        }
    }

    proptest! {
        /// The world's origin and axes are arbitrary.
        #[test]
        fn the_central_goal_turns_and_moves_with_the_scene(
            goals in prop::collection::vec(prop::array::uniform2(-9.0..9.0_f64), 1..20),
            observed in prop::collection::vec(prop::array::uniform2(-0.02..0.02_f64), 8),
            (turn, x, y) in (0.0..6.3_f64, -50.0..50.0_f64, -50.0..50.0_f64),
        ) {
            let observed: Vec<[f64; 2]> = observed.iter().zip(walk(0.0)).map(|(a, b)| [a[0] + b[0], a[1] + b[1]]).collect();
            let (sin, cos) = turn.sin_cos();
            let image = |[a, b]: [f64; 2]| [cos * a - sin * b + x, sin * a + cos * b + y];
            let images = |points: &[[f64; 2]]| -> Vec<[f64; 2]> { points.iter().map(|&p| image(p)).collect() };
            let here = image(set(&goals).central(&observed));
            let there = set(&images(&goals)).central(&images(&observed));
            // the median is iterated until a step is below 0.1 mm
            prop_assert!((here[0] - there[0]).hypot(here[1] - there[1]) < 0.02);
        }
    }
}
