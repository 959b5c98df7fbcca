//! Greedy k-means++: first centres that are far apart.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::points::{Points, squared_distance};

/// Chooses `clusters` of the points as first centres.
///
/// The first is drawn by multiplicity; each further one is the best of 2 + ln K draws with probability proportional to
/// the squared distance to the centres so far (times multiplicity), best being the draw that leaves the least sum of those.
///
/// # References
/// Arthur & Vassilvitskii, *k-means++: the advantages of careful seeding*, SODA 2007 (the greedy variant of section 5).
pub(crate) fn first_centres(
    points: &Points,
    clusters: usize,
    rng: &mut ChaCha8Rng,
) -> Vec<[f64; 2]> {
    #[expect(
        clippy::cast_sign_loss,
        reason = "the logarithm of at least 1 is not negative"
    )]
    let draws = 2 + (clusters as f64).ln() as usize;
    let first = points.get(draw(&points.weight, rng));
    let mut centres = vec![first];
    let mut nearest = distances(points, first);
    let mut weighted = vec![0.0; points.len()];
    let mut best = vec![0.0; points.len()];
    let mut trial = vec![0.0; points.len()];
    while centres.len() < clusters {
        for ((weighted, nearest), weight) in weighted.iter_mut().zip(&nearest).zip(&points.weight) {
            *weighted = nearest * weight;
        }
        let mut chosen = (f64::INFINITY, first);
        for _ in 0..draws {
            let candidate = points.get(draw(&weighted, rng));
            let potential = add_centre(points, &nearest, candidate, &mut trial);
            if potential < chosen.0 {
                chosen = (potential, candidate);
                std::mem::swap(&mut best, &mut trial);
            }
        }
        centres.push(chosen.1);
        std::mem::swap(&mut nearest, &mut best);
    }
    centres
}

fn distances(points: &Points, centre: [f64; 2]) -> Vec<f64> {
    points
        .x
        .iter()
        .zip(&points.y)
        .map(|(&x, &y)| squared_distance([x, y], centre))
        .collect()
}

/// Squared distances to the nearest centre once `centre` is one, written to `into`, and their weighted sum.
fn add_centre(points: &Points, nearest: &[f64], centre: [f64; 2], into: &mut [f64]) -> f64 {
    let positions = points.x.iter().zip(&points.y);
    for ((into, nearest), (&x, &y)) in into.iter_mut().zip(nearest).zip(positions) {
        let distance = squared_distance([x, y], centre);
        *into = if distance < *nearest {
            distance
        } else {
            *nearest
        };
    }
    into.iter()
        .zip(&points.weight)
        .map(|(distance, weight)| distance * weight)
        .sum()
}

/// Index drawn with probability proportional to `weights`; uniform when all are 0.
fn draw(weights: &[f64], rng: &mut ChaCha8Rng) -> usize {
    let total: f64 = weights.iter().sum();
    if total <= 0.0 {
        return rng.random_range(0..weights.len());
    }
    let mut left = rng.random::<f64>() * total;
    let mut last = 0;
    for (index, &weight) in weights.iter().enumerate() {
        if weight > 0.0 {
            last = index;
            if left < weight {
                break;
            }
            left -= weight;
        }
    }
    last
}
