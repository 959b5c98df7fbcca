//! The goals estimated for one walker.

use crate::expert::Expert;
use crate::points::squared_distance;

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
