//! Few goals that stand for many weighted points.

use crate::lloyd::Lloyd;
use crate::points::Points;
use crate::split::first_centres;

/// Goals with the weight of the points nearest to each.
pub(crate) struct Choice {
    pub(crate) goals: Vec<[f64; 2]>,
    pub(crate) weights: Vec<f64>,
}

/// Chooses `clusters` goals such that the weighted mean distance of a point to the nearest goal is small: cells are cut in
/// two, the costliest first, then `steps` of Lloyd's iteration. Nothing is random. Where there are fewer distinct points,
/// goals are repeated with weight 0.
pub(crate) fn choose(points: &Points, clusters: usize, steps: usize) -> Choice {
    let centres = first_centres(points, clusters).into_iter().cycle();
    let mut run = Lloyd::from_centres(points, centres.take(clusters).collect());
    run.iterate(points, steps, 0.0);
    let mut weights = vec![0.0; clusters];
    for (&label, weight) in run.labels.iter().zip(&points.weight) {
        weights[label as usize] += weight;
    }
    Choice {
        goals: run.centres,
        weights,
    }
}
