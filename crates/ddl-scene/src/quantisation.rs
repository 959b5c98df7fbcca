//! K clusters of the samples, as points of the joint space of all pedestrians: k-means.
//!
//! The quantisation of the joint distribution keeps the error of the best of K futures small: each future is the mean
//! of a cluster of similar scenes. A sample is a hypothesis of each pedestrian, so its squared distance to a centre is
//! a sum over pedestrians of entries of small tables, and a centre is the number of its samples with each hypothesis.

use crate::hypotheses::Hypotheses;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Steps that represent a path: 1.6, 3.2 and 4.8 s.
const STEPS: [usize; 3] = [4, 8, 12];
const MOST_ITERATIONS: usize = 6;

/// The cluster of each sample, `[S]`, 0 to `clusters` - 1.
pub(crate) fn clusters(people: &[Hypotheses], chosen: &[Vec<u8>], clusters: usize) -> Vec<usize> {
    let count = chosen.first().map_or(0, Vec::len);
    let mut centres = first_centres(people, chosen, count, clusters);
    let mut labels = vec![0; count];
    for iteration in 0..MOST_ITERATIONS {
        let distances = distances(people, chosen, &centres);
        let nearest: Vec<usize> = distances.chunks_exact(centres.len()).map(least).collect();
        if iteration > 0 && nearest == labels {
            break;
        }
        labels = nearest;
        centres = means(people, chosen, &labels, &centres);
    }
    labels
}

/// A centre: `[N]` of the steps' x, then y, relative to the present positions, metres.
type Centre = Vec<[[f32; STEPS.len()]; 2]>;

/// k-means++: each next centre is a sample, drawn in proportion to its squared distance to the centres so far. Fewer
/// where there are fewer different samples.
fn first_centres(people: &[Hypotheses], chosen: &[Vec<u8>], count: usize, clusters: usize) -> Vec<Centre> {
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let sample = |s: usize| people.iter().zip(chosen).map(|(one, chosen)| place(one, usize::from(chosen[s]))).collect();
    let mut centres: Vec<Centre> = vec![sample(0)];
    let mut nearest = vec![f32::INFINITY; count];
    while centres.len() < clusters {
        let to_last = distances(people, chosen, &centres[centres.len() - 1..]);
        for (nearest, distance) in nearest.iter_mut().zip(to_last) {
            *nearest = nearest.min(distance);
        }
        let total: f32 = nearest.iter().sum();
        let mut rest = random.random::<f32>() * total;
        let drawn = nearest.iter().position(|distance| {
            rest -= distance;
            rest < 0.0
        });
        match drawn {
            Some(s) if total > 0.0 => centres.push(sample(s)),
            _ => break,
        }
    }
    centres
}

fn place(one: &Hypotheses, hypothesis: usize) -> [[f32; STEPS.len()]; 2] {
    [0, 1].map(|axis| STEPS.map(|t| one.at(axis, t)[hypothesis]))
}

/// Squared distances `[S][centres]` (m²).
fn distances(people: &[Hypotheses], chosen: &[Vec<u8>], centres: &[Centre]) -> Vec<f32> {
    let count = chosen.first().map_or(0, Vec::len);
    let mut distances = vec![0.0; count * centres.len()];
    let mut table = Vec::new();
    for (i, (one, chosen)) in people.iter().zip(chosen).enumerate() {
        table.clear();
        for hypothesis in 0..one.count() {
            let [x, y] = place(one, hypothesis);
            table.extend(centres.iter().map(|centre| {
                let [cx, cy] = &centre[i];
                (0..STEPS.len()).map(|t| (x[t] - cx[t]) * (x[t] - cx[t]) + (y[t] - cy[t]) * (y[t] - cy[t])).sum::<f32>()
            }));
        }
        for (sums, &hypothesis) in distances.chunks_exact_mut(centres.len()).zip(chosen) {
            let row = &table[usize::from(hypothesis) * centres.len()..][..centres.len()];
            for (sum, distance) in sums.iter_mut().zip(row) {
                *sum += distance;
            }
        }
    }
    distances
}

/// The means of the clusters; a cluster without samples keeps its centre.
fn means(people: &[Hypotheses], chosen: &[Vec<u8>], labels: &[usize], before: &[Centre]) -> Vec<Centre> {
    let mut sizes = vec![0.0_f32; before.len()];
    for &label in labels {
        sizes[label] += 1.0;
    }
    let mut centres = before.to_vec();
    for (i, (one, chosen)) in people.iter().zip(chosen).enumerate() {
        let mut shares = vec![0.0_f32; before.len() * one.count()];
        for (&label, &hypothesis) in labels.iter().zip(chosen) {
            shares[label * one.count() + usize::from(hypothesis)] += 1.0 / sizes[label];
        }
        for ((centre, shares), _) in
            centres.iter_mut().zip(shares.chunks_exact(one.count())).zip(&sizes).filter(|(_, size)| **size > 0.0)
        {
            let mean = |axis: usize, t: usize| one.at(axis, t).iter().zip(shares).map(|(x, share)| x * share).sum();
            centre[i] = [0, 1].map(|axis| STEPS.map(|t| mean(axis, t)));
        }
    }
    centres
}

/// The index of the least number, the first of equal ones.
fn least(distances: &[f32]) -> usize {
    distances.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(index, _)| index)
}

#[cfg(test)]
mod tests;
