//! The goals estimated for one pedestrian.

use crate::choice::choose;
use crate::error::GoalError;
use crate::expert::Expert;
use crate::geometric_median::geometric_median;
use crate::heading::HeadingFrame;
use crate::params::MOST_CLUSTERS;
use crate::points::{Points, is_in_range, squared_distance};

/// Steps of Lloyd's iteration of [`GoalSet::from_endpoints`].
const STEPS: usize = 10;

/// Weighted goals of one pedestrian, most likely first.
///
/// Goals of equal weight are ordered by their first, then their second coordinate, so that equal inputs give equal
/// results.
#[derive(Clone, Debug, PartialEq)]
pub struct GoalSet {
    goals: Vec<[f64; 2]>,
    weights: Vec<f64>,
    estimated: Option<Vec<f64>>,
    experts: Vec<Expert>,
}

impl GoalSet {
    /// Goals with one weight each, summing to 1, in any order.
    pub(crate) fn new(goals: Vec<[f64; 2]>, weights: Vec<f64>, experts: Vec<Expert>) -> Self {
        let mut ranked: Vec<([f64; 2], f64)> = goals.into_iter().zip(weights).collect();
        ranked.sort_by(|(a, a_weight), (b, b_weight)| {
            b_weight.total_cmp(a_weight).then(a[0].total_cmp(&b[0])).then(a[1].total_cmp(&b[1]))
        });
        let (goals, weights) = ranked.into_iter().unzip();
        Self { goals, weights, estimated: None, experts }
    }

    /// `clusters` goals such that the weighted mean distance of an endpoint to its nearest goal is small.
    ///
    /// Cells of endpoints are divided in two, the costliest first; then steps of Lloyd's iteration follow. The result
    /// is deterministic. A goal's weight is the sum of the weights of the endpoints nearest to it.
    ///
    /// # Shapes
    /// `ends` (m, in the pedestrian's `frame`) and `weights` (not negative, not all 0): the same number of each, at
    /// least one. If there are fewer distinct endpoints than goals, goals are repeated with weight 0.
    ///
    /// # Errors
    /// [`GoalError::Ends`] if the lists differ in length, or if an endpoint or weight is not finite or out of range.
    ///
    /// # Examples
    /// ```
    /// use ddl_goal::{GoalSet, HeadingFrame};
    /// let frame = HeadingFrame::new(&[[0.0, 0.0], [0.0, 1.0]])?; // heading along y
    /// let ends = [[4.0, 0.0], [4.0, 1.0], [9.0, 0.0]];
    /// let set = GoalSet::from_endpoints(&frame, &ends, &[0.25, 0.25, 0.5], 2)?;
    /// assert_eq!(set.weights(), [0.5, 0.5]);
    /// assert!(set.goals().contains(&[0.0, 10.0])); // 9 m ahead of [0, 1]
    /// # Ok::<(), ddl_goal::GoalError>(())
    /// ```
    pub fn from_endpoints(
        frame: &HeadingFrame,
        ends: &[[f64; 2]],
        weights: &[f64],
        clusters: usize,
    ) -> Result<Self, GoalError> {
        let wrong = |problem: String| Err(GoalError::Ends { problem });
        if ends.is_empty() || ends.len() != weights.len() || !(1..=MOST_CLUSTERS).contains(&clusters) {
            let (ends, weights) = (ends.len(), weights.len());
            return wrong(format!(
                "{ends} endpoints with {weights} weights for {clusters} goals: need one weight per endpoint, at least \
                 one endpoint, and 1 to {MOST_CLUSTERS} goals"
            ));
        }
        let total: f64 = weights.iter().sum();
        if !(total.is_finite() && total > 0.0 && weights.iter().all(|&weight| weight >= 0.0)) {
            return wrong(format!("the weights sum to {total}: they must be finite, not negative, and not all 0"));
        }
        let mut points = Points::default();
        for (index, (&end, weight)) in ends.iter().zip(weights).enumerate() {
            if !is_in_range(end) {
                return wrong(format!(
                    "endpoint {index} is ({}, {}): coordinates must be finite and below 1e150",
                    end[0], end[1]
                ));
            }
            // The normalised weight may underflow to 0.
            let share = weight / total;
            if share > 0.0 {
                points.push(end, share);
            }
        }
        let (goals, weights) = choose(&points, clusters, STEPS);
        let goals: Vec<_> = goals.iter().map(|&end| frame.to_world(end)).collect();
        Ok(Self::new(goals, weights, Vec::new()))
    }

    /// The goals (m, in the coordinates of the observed track), as many as clusters requested. Goals are repeated if
    /// the experts have fewer distinct endpoints.
    pub fn goals(&self) -> &[[f64; 2]] {
        &self.goals
    }

    /// Estimated probability of each goal of being the one nearest to the true endpoint; the sum is 1.
    ///
    /// It is the share of the experts whose transformed endpoint is nearest to the goal. Experts count by similarity
    /// ([`crate::RetrievalFrame::Heading`]) or equally ([`crate::RetrievalFrame::World`]). Of repeated goals, one has
    /// the whole weight and the others have weight 0.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The same set with every goal farther than `radius` (m, not negative) from `centre` moved to that distance.
    #[must_use]
    pub fn clamped_to(mut self, centre: [f64; 2], radius: f64) -> Self {
        for goal in &mut self.goals {
            let way = [goal[0] - centre[0], goal[1] - centre[1]];
            let distance = way[0].hypot(way[1]);
            if distance > radius {
                *goal = [0, 1].map(|axis| centre[axis] + way[axis] / distance * radius);
            }
        }
        self
    }

    /// The same set, widened about its [`median`](Self::median) by one factor, so that the mean of the variances on both
    /// axes grows by that of this standard deviation (m, not negative): for a pedestrian whose motion is not well
    /// known. Goals that coincide stay.
    #[must_use]
    pub fn widened_by(mut self, deviation: f64) -> Self {
        let median = self.median();
        let goals = self.goals.iter().zip(&self.weights);
        let variance: f64 = goals.map(|(&goal, weight)| weight * squared_distance(goal, median) / 2.0).sum();
        if deviation > 0.0 && variance > 0.0 {
            let factor = (1.0 + deviation * deviation / variance).sqrt();
            for goal in &mut self.goals {
                *goal = [0, 1].map(|axis| median[axis] + factor * (goal[axis] - median[axis]));
            }
        }
        self
    }

    /// The same goals with flatter or steeper weights. Each weight is raised to `power` (positive) and divided by the
    /// sum. Then the share `uniform` (0 to 1) of the probability is divided equally among all goals. The order and the
    /// [`median`](Self::median) do not change.
    #[must_use]
    pub fn tempered(mut self, power: f64, uniform: f64) -> Self {
        let powers: Vec<f64> = self.weights.iter().map(|weight| weight.powf(power)).collect();
        let total: f64 = powers.iter().sum();
        let equal = uniform / powers.len().max(1) as f64;
        let tempered = powers.iter().map(|w| (1.0 - uniform) * w / total + equal);
        let weights = std::mem::replace(&mut self.weights, tempered.collect());
        self.estimated.get_or_insert(weights);
        self
    }

    /// The geometric median of the goals. It minimises the mean distance to them under their weights raised to the
    /// power 1.5, before they were [tempered](Self::tempered). It need not be a goal of the
    /// set.
    ///
    /// # Numerics
    /// The median is exactly a goal if the weight of that goal exceeds the pull of all others. Otherwise it is iterated
    /// until a step is below 0.1 mm, at most 100 times. No goal has a smaller mean distance.
    pub fn median(&self) -> [f64; 2] {
        let estimated = self.estimated.as_ref().unwrap_or(&self.weights);
        let sharpened: Vec<f64> = estimated.iter().map(|weight| weight.powf(Self::SHARPNESS)).collect();
        geometric_median(&self.goals, &sharpened)
    }

    /// Power of the weights in [`median`](Self::median), chosen on validation splits of training recordings.
    const SHARPNESS: f64 = 1.5;

    /// Index of the goal nearest to `point` (m), the first of equally near ones. With the true endpoint this is the
    /// oracle choice of the published protocol.
    pub fn nearest(&self, point: [f64; 2]) -> usize {
        let distances = self.goals.iter().map(|&goal| squared_distance(goal, point));
        distances.enumerate().min_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(index, _)| index)
    }

    /// The experts that the goals come from, most similar first; in [`crate::RetrievalFrame::Heading`] the first 100.
    pub fn experts(&self) -> &[Expert] {
        &self.experts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: (6, 8) and (-3, 0) are 10 m and 3 m away from (1, 1); goals within the radius keep every bit.
    #[test]
    fn goals_beyond_the_radius_are_moved_to_it() {
        let goals = vec![[7.0, 9.0], [-2.0, 1.0], [1.1, 1.7]];
        let set = GoalSet::new(goals, vec![0.5, 0.3, 0.2], Vec::new());
        let drawn = set.clone().clamped_to([1.0, 1.0], 5.0);
        assert!(squared_distance(drawn.goals()[0], [4.0, 5.0]) < 1e-24);
        assert_eq!(drawn.goals()[1..], set.goals()[1..]);
        let [x, y] = [0.1_f64, 0.7];
        for scale in 1..50 {
            let goal = [x * f64::from(scale), y * f64::from(scale)];
            let set = GoalSet::new(vec![goal], vec![1.0], Vec::new());
            assert_eq!(set.clamped_to([0.0; 2], goal[0].hypot(goal[1])).goals(), [goal]);
        }
    }

    /// By hand: the square roots of 0.64, 0.16 and 0.04 are in proportion 4 : 2 : 1; a tenth of the probability is
    /// divided equally.
    #[test]
    fn tempered_weights_are_powers_and_a_share_for_all() {
        let goals = vec![[3.0, 1.0], [4.0, 1.0], [9.0, 1.0]];
        let set = GoalSet::new(goals, vec![0.64, 0.16, 0.04], Vec::new());
        let flat = set.clone().tempered(0.5, 0.1);
        for (weight, share) in flat.weights().iter().zip([4.0, 2.0, 1.0]) {
            let expected = 0.9 * share / 7.0 + 0.1 / 3.0;
            assert!((weight - expected).abs() < 1e-12, "{flat:?}");
        }
        let median = set.median().map(f64::to_bits);
        assert_eq!(flat.tempered(3.0, 0.0).median().map(f64::to_bits), median);
    }

    #[test]
    fn equal_weights_are_ordered_by_place_and_the_first_of_equally_near_goals_is_the_nearest() {
        let goals = vec![[2.0, 5.0], [2.0, -5.0], [-1.0, 0.0], [9.0, 9.0]];
        let set = GoalSet::new(goals, vec![0.2, 0.2, 0.2, 0.4], Vec::new());
        let ordered = [[9.0, 9.0], [-1.0, 0.0], [2.0, -5.0], [2.0, 5.0]];
        assert_eq!(set.goals(), ordered);
        let nearest = [[8.0, 8.0], [-1.0, 1.0], [6.0, 0.0], [2.0, 4.0]].map(|p| set.nearest(p));
        assert_eq!(nearest, [0, 1, 2, 3]);
    }

    /// By hand: 0.45 is less than the sum of the other weights, but 0.45^1.5 = 0.302 is more than 0.2^1.5 +
    /// 0.35^1.5 = 0.297.
    #[test]
    #[expect(clippy::float_cmp, reason = "the median is exactly a goal")]
    fn the_median_uses_sharpened_weights() {
        let goals = vec![[3.0, 1.0], [4.0, 1.0], [9.0, 1.0]];
        let set = GoalSet::new(goals, vec![0.45, 0.2, 0.35], Vec::new());
        assert_eq!(set.median(), [3.0, 1.0]);
    }
}
