//! The goals estimated for one walker.

use ddl_softdtw::Neighbour;

use crate::kmeans::Clustering;
use crate::points::squared_distance;

/// Possible goals of one walker with their weights, most likely first.
///
/// Goals of equal weight are ordered by their first, then their second coordinate, so that equal inputs give equal bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct GoalSet {
    goals: Vec<[f64; 2]>,
    weights: Vec<f64>,
    experts: Vec<Neighbour>,
}

impl GoalSet {
    /// Goals at `origin` plus the centres of a clustering of the experts' relative endpoints.
    pub(crate) fn new(origin: [f64; 2], clustering: &Clustering, experts: Vec<Neighbour>) -> Self {
        let total = clustering.labels().len() as f64;
        let mut ranked: Vec<([f64; 2], usize)> = clustering
            .centres()
            .iter()
            .copied()
            .zip(clustering.sizes())
            .collect();
        ranked.sort_by(|(a, a_size), (b, b_size)| {
            b_size
                .cmp(a_size)
                .then(a[0].total_cmp(&b[0]))
                .then(a[1].total_cmp(&b[1]))
        });
        Self {
            goals: ranked
                .iter()
                .map(|(c, _)| [origin[0] + c[0], origin[1] + c[1]])
                .collect(),
            weights: ranked
                .iter()
                .map(|&(_, size)| size as f64 / total)
                .collect(),
            experts,
        }
    }

    /// The goals (m, in the coordinates of the observed track): always exactly as many as clusters were asked for.
    ///
    /// Where the experts ended at fewer distinct places than that (people who stand), goals are repeated.
    pub fn goals(&self) -> &[[f64; 2]] {
        &self.goals
    }

    /// Share of the experts that ended nearest to each goal; sums to 1.
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
    pub fn experts(&self) -> &[Neighbour] {
        &self.experts
    }
}
