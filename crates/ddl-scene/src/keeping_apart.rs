//! Paths of one future that do not collide.
//!
//! A future is the mean of similar samples. The mean may lead two people through each other where its samples do not,
//! and a few samples collide too. Then one of the two follows one of its hypotheses instead: of those that collide with
//! the fewest others, the one nearest to the mean. Two who are that close already stay as they are: they collide on
//! every path, because the present counts.

use crate::hypotheses::{Hypotheses, HypothesisPath, least_squared};
use crate::pairs::{Pair, neighbours};
use ddl_core::HORIZON;
use std::array;

/// Rounds in which paths that collide are replaced.
const ROUNDS: usize = 3;
/// Paths are kept apart by this multiple of the distance at which they collide, because the flow to a mean goal is not
/// exactly the mean of the paths.
const MARGIN: f32 = 1.05;

/// Changes the shares of the hypotheses of each pedestrian, `[N][H]`, where paths of a pair collide.
pub(crate) fn keep_apart(people: &[Hypotheses], pairs: &[Pair], shares: &mut [&mut [f32]]) {
    let means = people.iter().zip(shares.iter()).map(|(one, shares)| one.mean(&shares[..one.count()]));
    let means: Vec<HypothesisPath> = means.collect();
    let mut paths = means.clone();
    let collide = |pair: &Pair, first: &HypothesisPath, second: &HypothesisPath| collide(people, pair, first, second);
    let still = [[0.0; HORIZON + 1]; 2];
    let touching = || -> Vec<bool> { pairs.iter().map(|pair| collide(pair, &still, &still)).collect() };
    let mut of_all = None;
    for _ in 0..ROUNDS {
        let mut changed = false;
        for pair in pairs {
            if !collide(pair, &paths[pair.first], &paths[pair.second]) {
                continue;
            }
            let (partners, touch) = of_all.get_or_insert_with(|| (neighbours(people.len(), pairs), touching()));
            // Those beyond `most` are not counted: a candidate that collides as often as now is of no use. Pairs
            // that touch at the moment itself collide on every path, so they are not counted either.
            let collisions = |i: usize, path: &HypothesisPath, most: usize| {
                let with = |&&(index, other): &&(usize, usize)| {
                    let pair = &pairs[index];
                    let [first, second] = if pair.first == i { [path, &paths[other]] } else { [&paths[other], path] };
                    !touch[index] && collide(pair, first, second)
                };
                partners[i].iter().filter(with).take(most).count()
            };
            let candidates = [pair.first, pair.second].into_iter().flat_map(|i| {
                let now = collisions(i, &paths[i], usize::MAX);
                let possible = (0..people[i].count()).filter(move |&h| now > 0 && people[i].weights[h] > 0.0);
                possible.map(move |hypothesis| (i, hypothesis, now))
            });
            let costs = candidates.filter_map(|(i, hypothesis, now)| {
                let path = people[i].path(hypothesis);
                let then = collisions(i, &path, now);
                (then < now).then(|| (now - then, far(&path, &means[i]), i, hypothesis))
            });
            let best = costs.min_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
            if let Some((_, _, i, hypothesis)) = best {
                paths[i] = people[i].path(hypothesis);
                shares[i].fill(0.0);
                shares[i][hypothesis] = 1.0;
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
}

/// Whether two paths of a pair come too close, from the present on.
fn collide(people: &[Hypotheses], pair: &Pair, first: &HypothesisPath, second: &HypothesisPath) -> bool {
    let apart = (MARGIN * pair.energy.near + pair.energy.radius).powi(2);
    let [from, to] = [pair.first, pair.second].map(|i| people[i].present);
    let offset = [0, 1].map(|axis| (to[axis] - from[axis]) as f32);
    let between = |axis: usize, t: usize| second[axis][t] + offset[axis] - first[axis][t];
    let [x, y]: HypothesisPath = [0, 1].map(|axis| array::from_fn(|t| between(axis, t)));
    let squared: [f32; HORIZON] = array::from_fn(|t| least_squared([x[t], y[t]], [x[t + 1], y[t + 1]]));
    squared.iter().any(|squared| *squared < apart)
}

/// Sum of the distances of two paths at all steps, metres.
fn far(a: &HypothesisPath, b: &HypothesisPath) -> f32 {
    (0..=HORIZON).map(|t| (a[0][t] - b[0][t]).hypot(a[1][t] - b[1][t])).sum()
}

#[cfg(test)]
mod tests;
