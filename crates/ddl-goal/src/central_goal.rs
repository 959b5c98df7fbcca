//! The central goal, for forecasts with a single goal.

use crate::goal_set::GoalSet;
use ddl_core::HORIZON;
use ddl_core::motion::JITTER;

/// Weight of the endpoint extrapolated from the last step, for steps that change little.
const TRUST: f64 = 0.7;
/// Weight of the endpoint extrapolated from the mean velocity, for positions with independent errors.
const STEADINESS: f64 = 0.3;
/// Mean change of the step (m) below which the motion is simply extrapolated.
const EXACT: f64 = 0.005;
/// Share of the mean change of the step. A pedestrian whose mean step is shorter than this stands.
const STANDING: f64 = 0.5;
/// Step (m) above which a pedestrian walks; cosines of the angles between steps that go the same way, and back.
const WALKING: f64 = 0.16;
const SAME_WAY: f64 = 0.8;
const BACK: f64 = -0.5;
/// Independent errors of the positions give successive changes of the step the correlation -2/3.
const OF_ERRORS: f64 = -2.0 / 3.0;

impl GoalSet {
    /// The single best goal: the [`median`](Self::median) of the goals, moved towards the extrapolation of the observed
    /// velocity. The 8 observed frames determine how far.
    ///
    /// Let m be the median, p the last observed position, s the last step, a the mean step, d the changes of the step
    /// and w their mean length. Then:
    ///
    /// - n is the share of d that errors of the positions explain: the correlation of successive d, divided by -2/3,
    ///   clamped to 0..1;
    /// - b = 0.7 (1 - n) exp(-(w / 6 cm)²) |a|² / (|a|² + (w/2)²) is the weight of the last step, 0 for a standing
    ///   pedestrian with noise;
    /// - x = exp(-(w / 5 mm)²) measures how uniform the motion is.
    ///
    /// The goal is g + x (p + 12 s - g) with g = m + b (p + 12 s - m) + 0.3 n (p + 12 a - m). The constants
    /// were chosen on validation splits of training recordings.
    ///
    /// Who has turned by more than 120°, and whose last two steps agree, goes on at the mean velocity since the turn.
    ///
    /// # Shapes
    /// `observed`: the observed positions (m), the last one last. With fewer than three, the result is the median.
    pub fn central(&self, observed: &[[f64; 2]]) -> [f64; 2] {
        let median = self.median();
        if let Some(back) = since_reversal(observed)
            && let [first, .., last] = back
        {
            let ahead = HORIZON as f64 / (back.len() - 1) as f64;
            return std::array::from_fn(|axis| last[axis] + ahead * (last[axis] - first[axis]));
        }
        let &[first, .., before, last] = observed else { return median };
        let steps = (observed.len() - 1) as f64;
        let mean: [f64; 2] = std::array::from_fn(|axis| (last[axis] - first[axis]) / steps);
        let changes: Vec<[f64; 2]> = observed
            .array_windows::<3>()
            .map(|[a, b, c]| std::array::from_fn(|axis| c[axis] - 2.0 * b[axis] + a[axis]))
            .collect();
        let change = changes.iter().map(|[x, y]| x.hypot(*y)).sum::<f64>() / changes.len() as f64;
        let noise = noise_share(&changes);
        let standing = if change > 0.0 { STANDING * change / mean[0].hypot(mean[1]) } else { 0.0 };
        let walking = 1.0 / (1.0 + standing.powi(2));
        let trust = TRUST * (1.0 - noise) * (-(change / JITTER).powi(2)).exp() * walking;
        let exact = (-(change / EXACT).powi(2)).exp();
        std::array::from_fn(|axis| {
            let ahead = last[axis] + HORIZON as f64 * (last[axis] - before[axis]);
            let steady = last[axis] + HORIZON as f64 * mean[axis];
            let goal = median[axis] + trust * (ahead - median[axis]) + STEADINESS * noise * (steady - median[axis]);
            goal + exact * (ahead - goal)
        })
    }

    /// A set with only the [`central`](Self::central) goal, of weight 1; `observed` are the same positions (m).
    #[must_use]
    pub fn with_central_only(&self, observed: &[[f64; 2]]) -> Self {
        Self::new(vec![self.central(observed)], vec![1.0], self.experts().to_vec())
    }
}

/// The positions from the last turn by more than 120° on; `None` without one, or if the last two steps differ.
fn since_reversal(observed: &[[f64; 2]]) -> Option<&[[f64; 2]]> {
    let step = |end: usize| -> [f64; 2] { std::array::from_fn(|axis| observed[end][axis] - observed[end - 1][axis]) };
    let cosine = |[a, b]: [f64; 2], [c, d]: [f64; 2]| {
        let walks = a.hypot(b) > WALKING && c.hypot(d) > WALKING;
        if walks { (a * c + b * d) / (a.hypot(b) * c.hypot(d)) } else { 0.0 }
    };
    let last = observed.len().checked_sub(1).filter(|last| *last >= 3)?;
    if cosine(step(last), step(last - 1)) < SAME_WAY {
        return None;
    }
    let turned = (1..last - 1).rev().find(|&end| cosine(step(last), step(end)) < BACK)?;
    Some(&observed[turned + 1..])
}

/// n: the share of the step changes that errors of the positions explain, 0 to 1.
fn noise_share(changes: &[[f64; 2]]) -> f64 {
    let dot = |[a, b]: [f64; 2], [c, d]: [f64; 2]| a * c + b * d;
    let square = changes.iter().map(|&d| dot(d, d)).sum::<f64>() / changes.len() as f64;
    let pairs = changes.array_windows().map(|&[a, b]| dot(a, b));
    let count = pairs.len();
    let share = pairs.sum::<f64>() / count as f64 / square / OF_ERRORS;
    // With fewer than two changes, with changes that are all 0, or if squares overflow.
    if share.is_nan() {
        return 0.0;
    }
    share.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn set(goals: &[[f64; 2]]) -> GoalSet {
        let weights = vec![1.0 / goals.len() as f64; goals.len()];
        GoalSet::new(goals.to_vec(), weights, Vec::new())
    }

    /// 8 positions, one step of (0.5, 0) m a frame.
    fn walk() -> Vec<[f64; 2]> {
        (0..8_u32).map(|t| [0.5 * f64::from(t), 0.0]).collect()
    }

    /// The formula of [`GoalSet::central`], evaluated in numpy outside this project. The median is at (4, -2) m, the
    /// observation is x = a t, y = b t² + e (3 t mod 5). The cases: errors explain 0.36, 0 and 0.93 of the changes; x
    /// is 0.60; and three positions give no correlation.
    #[test]
    fn the_goal_agrees_with_the_formula() {
        for (a, b, e, positions, expected) in [
            (0.42, 0.006, 0.004, 8, [6.076_515_04, -0.398_573_36]),
            (0.40, 0.002, 0.0005, 8, [7.162_573_46, 0.107_064_57]),
            (0.03, 0.003, 0.004, 8, [2.894_013_2, -1.218_008_46]),
            (0.42, 0.006, 0.004, 3, [5.338_095_59, -0.471_154_61]),
        ] {
            let place = |t: i32| {
                let (t, error) = (f64::from(t), f64::from(3 * t % 5));
                [a * t, b * t * t + e * error]
            };
            let observed: Vec<[f64; 2]> = (0..positions).map(place).collect();
            let [x, y] = set(&[[4.0, -2.0]]).central(&observed);
            let miss = (x - expected[0]).hypot(y - expected[1]);
            assert!(miss < 1e-7, "{x} {y}, not {expected:?}");
        }
    }

    #[test]
    #[expect(clippy::float_cmp, reason = "the result is exact")]
    fn uniform_motion_is_extrapolated_and_noise_is_not() {
        let set = set(&[[4.0, -2.0]]);
        assert_eq!(set.central(&[[1.0, 2.0]; 8]), [1.0, 2.0]);
        let leaps: Vec<[f64; 2]> = (0..8).map(|t| [1e200 * f64::from(t % 3), 0.0]).collect();
        for observed in [&leaps[..], &[], &[[0.0, 0.0]], &[[0.0, 0.0], [1.0, 0.0]]] {
            assert_eq!(set.central(observed), [4.0, -2.0]);
        }
    }

    proptest! {
        #[test]
        fn the_central_goal_turns_and_moves_with_the_scene(
            goals in prop::collection::vec(prop::array::uniform2(-9.0..9.0_f64), 1..20),
            observed in prop::collection::vec(prop::array::uniform2(-0.02..0.02_f64), 8),
            (turn, x, y) in (0.0..6.3_f64, -50.0..50.0_f64, -50.0..50.0_f64),
        ) {
            let observed = observed.iter().zip(walk());
            let observed: Vec<[f64; 2]> = observed.map(|(a, b)| [a[0] + b[0], a[1] + b[1]]).collect();
            let (sin, cos) = turn.sin_cos();
            let image = |[a, b]: [f64; 2]| [cos * a - sin * b + x, sin * a + cos * b + y];
            let images = |points: &[[f64; 2]]| -> Vec<[f64; 2]> { points.iter().map(|&p| image(p)).collect() };
            let here = image(set(&goals).central(&observed));
            let there = set(&images(&goals)).central(&images(&observed));
            // The median is iterated until a step is below 0.1 mm.
            prop_assert!((here[0] - there[0]).hypot(here[1] - there[1]) < 0.02);
        }
    }
}
