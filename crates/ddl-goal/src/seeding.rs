//! Greedy k-means++: first centres that are far apart.

use crate::points::{Points, squared_distance};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Chooses `clusters` of the points as first centres.
///
/// The first is drawn by multiplicity. Each further centre is the best of 2 + ln K draws, whose probability is
/// proportional to the squared distance to the nearest centre so far (times multiplicity). The best draw leaves the
/// smallest sum of these distances.
///
/// # References
/// Arthur & Vassilvitskii, *k-means++: the advantages of careful seeding*, SODA 2007 (the greedy variant of section 5).
pub(crate) fn first_centres(points: &Points, clusters: usize, rng: &mut ChaCha8Rng) -> Vec<[f64; 2]> {
    #[expect(clippy::cast_sign_loss, reason = "the logarithm of at least 1 is not negative")]
    let draws = 2 + (clusters as f64).ln() as usize;
    let first = points.get(draw(&points.weight, rng));
    let mut centres = vec![first];
    let [mut nearest, mut weighted, mut best, mut trial] = [(); 4].map(|()| vec![0.0; points.len()]);
    add_centre(points, &vec![f64::INFINITY; points.len()], first, &mut nearest);
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

/// Writes the squared distances to the nearest centre, `centre` included, to `into`, and returns their weighted sum.
fn add_centre(points: &Points, nearest: &[f64], centre: [f64; 2], into: &mut [f64]) -> f64 {
    let positions = points.x.iter().zip(&points.y);
    for ((into, nearest), (&x, &y)) in into.iter_mut().zip(nearest).zip(positions) {
        let distance = squared_distance([x, y], centre);
        *into = if distance < *nearest { distance } else { *nearest };
    }
    into.iter().zip(&points.weight).map(|(distance, weight)| distance * weight).sum()
}

/// Index drawn with probability proportional to `weights`; uniform if all are 0.
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

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;

    use super::first_centres;
    use crate::points::Points;

    const SEEDS: u64 = 2000;

    /// By hand: the first centre is the heavy point at 0. The next is drawn twice: the point at 1 (squared distance
    /// times weight 8) with probability 2/3, the point at -2 with 1/3. The point at 1 is better (it leaves 4 m², the
    /// other 8), so it is chosen unless both draws are -2. Four standard deviations of the share over all draws are at
    /// most 0.045.
    #[test]
    fn the_next_centre_is_the_best_of_draws_by_squared_distance_and_weight() {
        let mut points = Points::default();
        for (x, weight) in [(0.0, 1e9), (1.0, 8.0), (-2.0, 1.0)] {
            points.push([x, 0.0], weight);
        }
        let next = |seed| first_centres(&points, 2, &mut ChaCha8Rng::seed_from_u64(seed))[1];
        let near = (0..SEEDS).filter(|&seed| next(seed)[0] > 0.5).count();
        let near = near as f64 / SEEDS as f64;
        assert!((near - 8.0 / 9.0).abs() < 0.045, "{near}");
    }
}
