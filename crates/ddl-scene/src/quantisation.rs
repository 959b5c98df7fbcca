//! K clusters of the samples, as points of the joint space of all pedestrians: k-means.
//!
//! The quantisation of the joint distribution keeps the error of the best of K futures small: each future is the mean
//! of a cluster of similar scenes.

use crate::hypotheses::Hypotheses;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Steps that represent a path: 1.6, 3.2 and 4.8 s.
const STEPS: [usize; 3] = [4, 8, 12];
/// Coordinates of a pedestrian in the joint space.
const OF_EACH: usize = 2 * STEPS.len();
const MOST_ITERATIONS: usize = 10;

/// The cluster of each sample, `[S]`, 0 to `clusters` - 1; every cluster has a sample if there are as many samples.
pub(crate) fn clusters(people: &[Hypotheses], chosen: &[Vec<u8>], clusters: usize) -> Vec<usize> {
    let points = points(people, chosen);
    let width = people.len() * OF_EACH;
    let count = points.len() / width;
    let point = |s: usize| &points[s * width..][..width];
    let mut centres = first_centres(&point, count, clusters);
    let mut labels = vec![0; count];
    for _ in 0..MOST_ITERATIONS {
        let nearest: Vec<usize> = (0..count).map(|s| nearest(point(s), &centres).0).collect();
        if nearest == labels {
            break;
        }
        labels = nearest;
        let mut sizes = vec![0.0_f32; centres.len()];
        let mut sums = vec![vec![0.0_f32; width]; centres.len()];
        for (s, &label) in labels.iter().enumerate() {
            sizes[label] += 1.0;
            for (sum, x) in sums[label].iter_mut().zip(point(s)) {
                *sum += x;
            }
        }
        for ((centre, mut sum), size) in centres.iter_mut().zip(sums).zip(&sizes) {
            if *size > 0.0 {
                for x in &mut sum {
                    *x /= size;
                }
                *centre = sum;
            }
        }
    }
    labels
}

/// The samples as points `[S][N x 6]`, metres from the present positions.
fn points(people: &[Hypotheses], chosen: &[Vec<u8>]) -> Vec<f32> {
    let count = chosen.first().map_or(0, Vec::len);
    let width = people.len() * OF_EACH;
    let mut points = vec![0.0; count * width];
    for (i, (one, chosen)) in people.iter().zip(chosen).enumerate() {
        for (s, &hypothesis) in chosen.iter().enumerate() {
            let point = &mut points[s * width + i * OF_EACH..][..OF_EACH];
            for (place, (axis, t)) in point.iter_mut().zip([0, 1].iter().flat_map(|a| STEPS.map(|t| (*a, t)))) {
                *place = one.at(axis, t)[usize::from(hypothesis)];
            }
        }
    }
    points
}

/// k-means++: each next centre is a sample, drawn in proportion to its squared distance to the centres so far.
fn first_centres<'a>(point: &impl Fn(usize) -> &'a [f32], count: usize, clusters: usize) -> Vec<Vec<f32>> {
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut centres = vec![point(0).to_vec()];
    let mut distances = vec![f32::INFINITY; count];
    while centres.len() < clusters {
        let Some(last) = centres.last() else { break };
        for (s, distance) in distances.iter_mut().enumerate() {
            *distance = distance.min(squared(point(s), last));
        }
        let total: f32 = distances.iter().sum();
        let mut rest = random.random::<f32>() * total;
        let drawn = distances.iter().position(|distance| {
            rest -= distance;
            rest < 0.0
        });
        match drawn {
            Some(s) if total > 0.0 => centres.push(point(s).to_vec()),
            // Fewer different samples than clusters.
            _ => break,
        }
    }
    centres
}

fn nearest(point: &[f32], centres: &[Vec<f32>]) -> (usize, f32) {
    let mut best = (0, f32::INFINITY);
    for (c, centre) in centres.iter().enumerate() {
        let distance = squared(point, centre);
        if distance < best.1 {
            best = (c, distance);
        }
    }
    best
}

/// Squared distance, in eight sums, which are computed on vectors.
fn squared(a: &[f32], b: &[f32]) -> f32 {
    let mut sums = [0.0_f32; 8];
    let (a_rows, b_rows) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f32 = a_rows
        .remainder()
        .iter()
        .zip(b_rows.remainder())
        .map(|(x, y)| (x - y) * (x - y))
        .sum();
    for (a, b) in a_rows.zip(b_rows) {
        for ((sum, x), y) in sums.iter_mut().zip(a).zip(b) {
            *sum += (x - y) * (x - y);
        }
    }
    sums.iter().sum::<f32>() + rest
}
