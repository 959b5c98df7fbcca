//! Samples of scenes: a hypothesis for each pedestrian, drawn by one Gibbs sweep.
//!
//! It starts from independent draws, so the samples follow the energy approximately. More sweeps changed the errors of
//! the best future by less than 1 %.

use crate::hypotheses::Hypotheses;
use crate::pairs::{Pair, neighbours};
use rand::SeedableRng as _;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;

/// Factors multiplied before the product is divided by its largest, so that it does not underflow.
const BETWEEN_RESCALES: usize = 4;

/// The hypothesis of each pedestrian in each sample, `[N][S]`.
///
/// Each pedestrian has its own random numbers, by its number among those whom it may influence. They are spread evenly
/// over the samples, so that shares of hypotheses are close to their probabilities.
pub(crate) fn samples(people: &[Hypotheses], pairs: &[Pair], numbers: &[u64], count: usize) -> Vec<Vec<u8>> {
    let draws = |i: usize, sweep: u64| {
        let order = shuffled(&mut random(numbers[i], sweep), count);
        order.into_iter().map(|s| (s as f32 + 0.5) / count as f32).collect::<Vec<f32>>()
    };
    let first =
        |(i, one): (usize, &Hypotheses)| draws(i, 0).into_iter().map(|share| draw(&one.weights, share)).collect();
    let mut chosen: Vec<Vec<u8>> = people.iter().enumerate().map(first).collect();
    let neighbours = neighbours(people.len(), pairs);
    let mut product = Vec::new();
    for (i, one) in people.iter().enumerate() {
        if neighbours[i].is_empty() {
            continue;
        }
        let mut own = std::mem::take(&mut chosen[i]);
        for ((s, hypothesis), share) in own.iter_mut().enumerate().zip(draws(i, 1)) {
            product.clone_from(&one.weights);
            for (n, &(pair, other)) in neighbours[i].iter().enumerate() {
                let pair = &pairs[pair];
                let factors = pair.factors(pair.first == i, usize::from(chosen[other][s]), one.count());
                for (value, factor) in product.iter_mut().zip(factors) {
                    *value *= factor;
                }
                if n % BETWEEN_RESCALES == BETWEEN_RESCALES - 1 {
                    let largest = product.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
                    for value in &mut product {
                        *value /= largest;
                    }
                }
            }
            *hypothesis = draw(&product, share);
        }
        chosen[i] = own;
    }
    chosen
}

/// Random numbers of a pedestrian for a sweep.
pub(crate) fn random(number: u64, sweep: u64) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(number);
    random.set_stream(sweep);
    random
}

/// The numbers below `count` in a random order.
pub(crate) fn shuffled(random: &mut ChaCha8Rng, count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.shuffle(random);
    order
}

/// The index at which the sum of the weights reaches a share (0 to 1) of the whole.
fn draw(weights: &[f32], share: f32) -> u8 {
    let total: f32 = weights.iter().sum();
    let mut rest = share * total;
    for (index, weight) in (0..).zip(weights) {
        rest -= weight;
        if rest < 0.0 {
            return index;
        }
    }
    weights.iter().rposition(|weight| *weight > 0.0).unwrap_or(0) as u8
}

#[cfg(test)]
mod tests;
