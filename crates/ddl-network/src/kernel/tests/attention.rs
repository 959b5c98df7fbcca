//! The formula of attention in f64, one query at a time.

use crate::kernel::heads::HEAD_WIDTH;
use crate::kernel::tests::numbers::wide;

/// Mixed values, and the gradients of queries, keys and values.
pub(crate) type Attention = (Vec<f64>, [Vec<f64>; 3]);

/// Attention of each row of queries over the rows `seen` by it, and the gradients of Σ `gradient` · mixed. `factor`
/// gives the factor of a weight, from the rows of query and key, and the head.
pub(crate) fn attention(
    inputs: [&[f32]; 3],
    gradient: &[f32],
    heads: usize,
    seen: &[Vec<usize>],
    factor: impl Fn(usize, usize, usize) -> f64,
) -> Attention {
    let ([queries, keys, values], gradient) = (inputs.map(wide), wide(gradient));
    let scale = 1.0 / (HEAD_WIDTH as f64).sqrt();
    let mut mixed = vec![0.0; queries.len()];
    let mut gradients = inputs.map(|input| vec![0.0; input.len()]);
    let [of_queries, of_keys, of_values] = &mut gradients;
    for (row, seen) in seen.iter().enumerate() {
        for head in 0..heads {
            let place = |row: usize| (row * heads + head) * HEAD_WIDTH..(row * heads + head + 1) * HEAD_WIDTH;
            let (query, gradient) = (&queries[place(row)], &gradient[place(row)]);
            let score = |&key: &usize| scale * dot(query, &keys[place(key)]);
            let scores: Vec<f64> = seen.iter().map(score).collect();
            let largest = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let powers: Vec<f64> = scores.iter().map(|score| (score - largest).exp()).collect();
            let sum: f64 = powers.iter().sum();
            let weights: Vec<f64> = powers.iter().map(|power| power / sum).collect();
            let of_weight = |&key: &usize| factor(row, key, head) * dot(gradient, &values[place(key)]);
            let of_weights: Vec<f64> = seen.iter().map(of_weight).collect();
            let mean = dot(&weights, &of_weights);
            for (&key, (weight, of_weight)) in seen.iter().zip(weights.iter().zip(of_weights)) {
                let taken = weight * factor(row, key, head);
                let of_score = scale * weight * (of_weight - mean);
                add(&mut mixed[place(row)], taken, &values[place(key)]);
                add(&mut of_values[place(key)], taken, gradient);
                add(&mut of_queries[place(row)], of_score, &keys[place(key)]);
                add(&mut of_keys[place(key)], of_score, query);
            }
        }
    }
    (mixed, gradients)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(sums: &mut [f64], factor: f64, terms: &[f64]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        *sum += factor * term;
    }
}
