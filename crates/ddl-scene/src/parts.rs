//! A scene as a product of independent parts.
//!
//! Two pedestrians are linked if some of their hypotheses come close to each other, or if they walk together; a part is
//! what links connect. The probability of a future is then a product over the parts, so that who is far away changes
//! nothing.

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

    /// Probabilities that somebody does something, from those that pedestrians do not do it, `[H]` of each with its
    /// index.
    pub(crate) fn somebody<'a, const D: usize>(
        &self,
        not_done: impl Iterator<Item = (usize, &'a [[f64; D]])>,
    ) -> [f64; D] {
        let row = |i: usize| self.pedestrians.partition_point(|other| *other < i);
        let is_done = |probabilities: &[f64; D]| probabilities.iter().any(|not_done| *not_done < 1.0);
        let of_each = not_done.map(|(i, probabilities)| {
            (&self.chosen[row(i)], probabilities, probabilities.iter().map(is_done).collect::<Vec<bool>>())
        });
        let of_each: Vec<_> = of_each.collect();
        let mut somebody = [0.0; D];
        for (s, &weight) in self.weights.iter().enumerate() {
            let mut nobody = [1.0; D];
            let of_sample = of_each.iter().filter_map(|(chosen, of_hypotheses, is_done)| {
                let hypothesis = usize::from(chosen[s]);
                is_done[hypothesis].then_some(&of_hypotheses[hypothesis])
            });
            let mut of_sample = of_sample.peekable();
            if of_sample.peek().is_none() {
                continue;
            }
            for probabilities in of_sample {
                for (nobody, not_done) in nobody.iter_mut().zip(probabilities) {
                    *nobody *= not_done;
                }
            }
            for (somebody, nobody) in somebody.iter_mut().zip(nobody) {
                *somebody += weight * (1.0 - nobody);
            }
        }
        somebody
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
