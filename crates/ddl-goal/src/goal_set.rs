//! The goals estimated for one walker.

use crate::expert::Expert;
use crate::points::squared_distance;

/// Metres.
const SMALLEST_DISTANCE: f64 = 1e-4;

/// Possible goals of one walker with their weights, most likely first.
///
/// Goals of equal weight are ordered by their first, then their second coordinate, so that equal inputs give equal bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct GoalSet {
    goals: Vec<[f64; 2]>,
    weights: Vec<f64>,
    experts: Vec<Expert>,
}

impl GoalSet {
    /// Goals with as many weights that sum to 1, in any order.
    pub(crate) fn new(goals: Vec<[f64; 2]>, weights: Vec<f64>, experts: Vec<Expert>) -> Self {
        let mut ranked: Vec<([f64; 2], f64)> = goals.into_iter().zip(weights).collect();
        ranked.sort_by(|(a, a_weight), (b, b_weight)| {
            b_weight
                .total_cmp(a_weight)
                .then(a[0].total_cmp(&b[0]))
                .then(a[1].total_cmp(&b[1]))
        });
        let (goals, weights) = ranked.into_iter().unzip();
        Self {
            goals,
            weights,
            experts,
        }
    }

    /// The goals (m, in the coordinates of the observed track): always exactly as many as clusters were asked for.
    ///
    /// Where the experts ended at fewer distinct places than that (people who stand), goals are repeated.
    pub fn goals(&self) -> &[[f64; 2]] {
        &self.goals
    }

    /// Estimated probability of each goal to be the one nearest the true end; sums to 1.
    ///
    /// It is the share of the experts whose carried-over end is nearest the goal, each expert counted by its likeness
    /// ([`crate::RetrievalFrame::Heading`]) or all alike ([`crate::RetrievalFrame::World`]).
    ///
    /// Of repeated goals one has the whole share and the others have 0.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Index of the goal with the largest weight: always 0.
    pub fn most_likely(&self) -> usize {
        0
    }

    /// The geometric median of the goals: it minimises the mean distance to them under their weights raised to the power
    /// [`SHARPNESS`](Self::SHARPNESS). No goal of the set need be there.
    ///
    /// # Numerics
    /// Weiszfeld's iteration from the weighted mean, until a step is below 0.1 mm, at most 100 steps; a goal nearer than that counts as
    /// 0.1 mm away.
    ///
    /// # References
    /// E. Weiszfeld, "Sur le point pour lequel la somme des distances de n points donnés est minimum", 1937.
    pub fn median(&self) -> [f64; 2] {
        let sharpened: Vec<f64> = self
            .weights
            .iter()
            .map(|weight| weight.powf(Self::SHARPNESS))
            .collect();
        let mean = |shares: &dyn Fn(usize) -> f64| {
            let mut sums = [0.0; 3];
            for (k, goal) in self.goals.iter().enumerate() {
                let share = shares(k);
                sums[0] += share * goal[0];
                sums[1] += share * goal[1];
                sums[2] += share;
            }
            [sums[0] / sums[2], sums[1] / sums[2]]
        };
        let mut centre = mean(&|k| sharpened[k]);
        for _ in 0..100 {
            let off = |k: usize| squared_distance(self.goals[k], centre).sqrt();
            let next = mean(&|k| sharpened[k] / off(k).max(SMALLEST_DISTANCE));
            let step = squared_distance(next, centre).sqrt();
            centre = next;
            if step < SMALLEST_DISTANCE {
                break;
            }
        }
        centre
    }

    /// Power of the weights in [`median`](Self::median), chosen on validation splits of training recordings for the choice among walks
    /// (`docs/accuracy.md`) and taken over: whoever stands is likelier to stay than the mean of all ways to leave says.
    pub const SHARPNESS: f64 = 1.5;

    /// Index of the goal nearest to `point` (m), the first of equally near ones.
    ///
    /// With the true end as `point` this is the oracle choice of the published protocol.
    pub fn nearest(&self, point: [f64; 2]) -> usize {
        let distances = self.goals.iter().map(|&goal| squared_distance(goal, point));
        distances
            .enumerate()
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
            .map_or(0, |(index, _)| index)
    }

    /// The walkers of the library the goals come from, most similar first.
    ///
    /// In [`crate::RetrievalFrame::Heading`] the first 100 of them.
    pub fn experts(&self) -> &[Expert] {
        &self.experts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn set(goals: &[[f64; 2]], weights: &[f64]) -> GoalSet {
        GoalSet::new(goals.to_vec(), weights.to_vec(), Vec::new())
    }

    /// Whoever has more than half of the sharpened weight is the geometric median itself.
    #[test]
    fn a_goal_with_most_of_the_weight_is_the_median() {
        let median = set(&[[3.0, 1.0], [0.0, 0.0], [5.0, 7.0]], &[0.6, 0.2, 0.2]).median();
        assert!(
            squared_distance(median, [3.0, 1.0]).sqrt() < 1e-3,
            "{median:?}"
        );
    }

    /// The Fermat point of a triangle sees its sides under 120 degrees: of an equilateral one it is the centre.
    #[test]
    fn equal_goals_of_a_triangle_meet_at_its_fermat_point() {
        let corners = [[0.0, 0.0], [2.0, 0.0], [1.0, 3.0_f64.sqrt()]];
        let median = set(&corners, &[1.0 / 3.0; 3]).median();
        assert!(squared_distance(median, [1.0, 1.0 / 3.0_f64.sqrt()]).sqrt() < 1e-3);
    }

    proptest! {
        /// No goal of the set is nearer to all of them together.
        #[test]
        fn nothing_is_more_central(
            goals in prop::collection::vec((prop::array::uniform2(-9.0..9.0_f64), 0.01..1.0_f64), 1..20),
        ) {
            let total: f64 = goals.iter().map(|(_, weight)| weight).sum();
            let (places, weights): (Vec<_>, Vec<_>) =
                goals.into_iter().map(|(goal, weight)| (goal, weight / total)).unzip();
            let set = set(&places, &weights);
            let cost = |point: [f64; 2]| -> f64 {
                let each = set.goals().iter().zip(set.weights());
                each.map(|(&goal, weight)| {
                    weight.powf(GoalSet::SHARPNESS) * squared_distance(goal, point).sqrt()
                })
                .sum()
            };
            let median = cost(set.median());
            for &goal in set.goals() {
                prop_assert!(median <= cost(goal) * (1.0 + 1e-3) + 1e-3);
            }
        }
    }
}
