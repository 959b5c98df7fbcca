//! A scene as a product of independent parts.
//!
//! Two pedestrians are linked if some of their hypotheses come close to each other, or if they walk together; a part is
//! what links connect. The probability of a future is then a product over the parts, so that who is far away changes
//! nothing.

#![expect(clippy::inline_always, reason = "kernels are compiled for the instructions of the processor")]

use crate::groups::Company;
use ddl_simd::{Dispatch, Kernel, Simd};
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

/// A pedestrian of a part that may do something.
#[derive(Debug)]
pub(crate) struct PartMember<const D: usize> {
    pub(crate) pedestrian: usize,
    /// For each hypothesis its row in `not_done`.
    pub(crate) rows: [u8; 256],
    /// Probabilities that it does not do it; the first row is for hypotheses on which it surely does not.
    pub(crate) not_done: Vec<[f64; D]>,
    /// Factors of the probabilities of its hypotheses; empty if they are 1.
    pub(crate) factors: Vec<f64>,
}

impl<const D: usize> PartMember<D> {
    /// Of a pedestrian with such probabilities not to do it on some of its hypotheses.
    pub(crate) fn new(pedestrian: usize, some: impl Iterator<Item = (usize, [f64; D])>, factors: Vec<f64>) -> Self {
        let (mut rows, mut not_done) = ([0; 256], vec![[1.0; D]]);
        for (row, (hypothesis, of_hypothesis)) in (1..=u8::MAX).zip(some) {
            rows[hypothesis] = row;
            not_done.push(of_hypothesis);
        }
        Self { pedestrian, rows, not_done, factors }
    }
}

/// The sum over the samples of a part.
struct PartSum<'a, const D: usize> {
    part: &'a ScenePart,
    /// With the hypothesis in each sample.
    of_each: &'a [(&'a PartMember<D>, &'a Vec<u8>)],
    total: f64,
    somebody: [f64; D],
}

impl<const D: usize> Kernel for &mut PartSum<'_, D> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        for (s, &weight) in self.part.weights.iter().enumerate() {
            let (mut weight, mut nobody, mut some) = (weight, [1.0; D], false);
            for (one, chosen) in self.of_each {
                let hypothesis = usize::from(chosen[s]);
                weight *= one.factors.get(hypothesis).unwrap_or(&1.0);
                let row = usize::from(one.rows[hypothesis]);
                if row > 0 {
                    some = true;
                    for (nobody, not_done) in nobody.iter_mut().zip(&one.not_done[row]) {
                        *nobody *= not_done;
                    }
                }
            }
            self.total += weight;
            if some {
                for (somebody, nobody) in self.somebody.iter_mut().zip(nobody) {
                    *somebody += weight * (1.0 - nobody);
                }
            }
        }
    }
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

    /// Probabilities that some of these pedestrians do something.
    pub(crate) fn somebody<const D: usize>(&self, members: &[PartMember<D>]) -> [f64; D] {
        let chosen =
            |one: &PartMember<D>| &self.chosen[self.pedestrians.partition_point(|other| *other < one.pedestrian)];
        let of_each: Vec<(&PartMember<D>, &Vec<u8>)> = members.iter().map(|one| (one, chosen(one))).collect();
        let mut sum = PartSum { part: self, of_each: &of_each, total: 0.0, somebody: [0.0; D] };
        Dispatch::detect().run(&mut sum);
        sum.somebody.map(|somebody| somebody / sum.total)
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
