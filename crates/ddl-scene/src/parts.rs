//! A scene as a product of independent parts.
//!
//! Two pedestrians are linked if some of their hypotheses come close to each other, or if they walk together; a part is
//! what links connect. The probability of a future is then a product over the parts, so that who is far away changes
//! nothing.

use crate::groups::Company;
use serde::{Deserialize, Serialize};

/// Pedestrians who may influence each other, and samples of what they do: in each, every one follows one of its
/// hypotheses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScenePart {
    /// Indices of its pedestrians, ascending.
    pub(crate) pedestrians: Vec<usize>,
    /// `[S]`; they sum to 1.
    pub(crate) weights: Vec<f64>,
    /// `[n][S]`: the hypothesis of each of the n pedestrians in each sample.
    pub(crate) chosen: Vec<Vec<u8>>,
}

/// The parts of a scene, and what the observation tells of its pedestrians.
#[derive(Debug, Clone)]
pub struct SceneParts {
    pub(crate) parts: Vec<ScenePart>,
    pub(crate) company: Company,
}

impl ScenePart {
    /// Pedestrians whose hypotheses k belong together: sample k has the weight k.
    pub(crate) fn together(pedestrians: Vec<usize>, weights: Vec<f64>) -> Self {
        let each: Vec<u8> = (0..=u8::MAX).take(weights.len()).collect();
        Self { chosen: vec![each; pedestrians.len()], pedestrians, weights }
    }

    /// A pedestrian that nobody influences: each of its hypotheses is a sample with its weight.
    pub(crate) fn alone(pedestrian: usize, weights: Vec<f64>) -> Self {
        Self::together(vec![pedestrian], weights)
    }

    /// Indices of its pedestrians, ascending.
    pub fn pedestrians(&self) -> &[usize] {
        &self.pedestrians
    }

    /// The probabilities of the `count` hypotheses of its n-th pedestrian, whatever the others do.
    pub(crate) fn shares(&self, n: usize, count: usize) -> Vec<f64> {
        let mut shares = vec![0.0; count];
        for (weight, &hypothesis) in self.weights.iter().zip(&self.chosen[n]) {
            shares[usize::from(hypothesis)] += weight;
        }
        shares
    }

    /// The probability that some pedestrians do something, of the probabilities that each does not, by hypothesis.
    pub(crate) fn somebody(&self, not_done: &[(usize, Vec<f64>)]) -> f64 {
        let of_each: Vec<(&Vec<u8>, &Vec<f64>)> = not_done
            .iter()
            .map(|(pedestrian, not_done)| {
                (&self.chosen[self.pedestrians.partition_point(|i| i < pedestrian)], not_done)
            })
            .collect();
        let nobody =
            |s: usize| of_each.iter().map(|(chosen, not_done)| not_done[usize::from(chosen[s])]).product::<f64>();
        self.weights.iter().enumerate().map(|(s, weight)| weight * (1.0 - nobody(s))).sum()
    }

    /// The part of those pedestrians who have a new index; `None` without any.
    pub(crate) fn renumbered(&self, index: impl Fn(usize) -> Option<usize>) -> Option<Self> {
        let members = self.pedestrians.iter().zip(&self.chosen);
        let mut kept: Vec<(usize, &Vec<u8>)> =
            members.filter_map(|(&i, chosen)| index(i).map(|i| (i, chosen))).collect();
        kept.sort_unstable_by_key(|&(i, _)| i);
        let (pedestrians, chosen): (Vec<usize>, Vec<Vec<u8>>) = kept.into_iter().map(|(i, c)| (i, c.clone())).unzip();
        (!pedestrians.is_empty()).then(|| Self { pedestrians, weights: self.weights.clone(), chosen })
    }
}
