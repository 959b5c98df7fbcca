//! Metrics of whole futures of a scene: hypothesis k of all its pedestrians is future k.
//!
//! ```text
//! JADE = min_k 1/N sum_i ADE_{i,k}, of each window; JFDE with FDE
//! c_k  = 1/N x the pedestrians whose centres come closer than d to those of another in future k
//! ```
//!
//! Futures count equally, whatever their weights. Pedestrians move straight between frames; the least distance from the
//! first to the last forecast frame is exact. The true future is measured in the same way, among the same pedestrians.
//!
//! "Joint Metrics Matter" (Weng et al., ICCV 2023) takes means over windows, of any number of pedestrians, and discs of
//! radius 0.1 m, so d = 0.2 m between centres (its evaluator, `ericaweng/joint-metrics-matter` at 894182b). Its
//! `CR_mean` is the mean of `c_k` over k, its `CR_JADE` is `c_k` of the future of JADE; a window of one pedestrian
//! counts as 0. Its windows are those of the rule `social-gan-1`. It gives the same numbers for exported
//! [samples](crate::external::write_samples).

use ddl_core::{Position, bounds};
use serde::{Deserialize, Serialize};

use crate::metric::collision::{PEDESTRIAN_RADIUS, closest_approach};
use crate::scored_window::ScoredWindow;

/// Centres nearer than these collide: elsewhere in this project, and in "Joint Metrics Matter"; metres, falling.
const TOO_NEAR: [f64; 2] = [2.0 * PEDESTRIAN_RADIUS, 0.2];

/// Metrics of the futures of scenes, beside JADE and JFDE over pedestrians.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct JointScores {
    /// JADE, mean over windows, metres.
    pub ade_windows: f64,
    /// JFDE, mean over windows, metres.
    pub fde_windows: f64,
    /// Share of pedestrians whose centres come closer than 0.4 m to those of another; mean over pedestrians.
    pub collisions: FutureCollisions,
    /// As `collisions` closer than 0.2 m; mean over windows of the share of their pedestrians.
    pub close_collisions: FutureCollisions,
}

/// Shares of pedestrians that collide within one future, in [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct FutureCollisions {
    /// Mean over the futures, which count equally.
    pub mean: f64,
    /// In the future of JADE.
    pub best: f64,
    /// In the true future.
    pub truth: f64,
}

impl FutureCollisions {
    fn plus(self, other: Self, times: f64) -> Self {
        Self {
            mean: self.mean + times * other.mean,
            best: self.best + times * other.best,
            truth: self.truth + times * other.truth,
        }
    }
}

impl JointScores {
    /// The means over scenes, each with its pedestrians, JADE and JFDE times the pedestrians, and collisions; `None`
    /// unless all have them.
    pub(crate) fn of<'a>(
        scenes: impl ExactSizeIterator<Item = (usize, [f64; 2], Option<&'a SceneFutures>)> + Clone,
    ) -> Option<Self> {
        let windows = scenes.len() as f64;
        let total: usize = scenes.clone().map(|(n, ..)| n).sum();
        let [mut collisions, mut close_collisions] = [FutureCollisions::default(); 2];
        let [mut ade_windows, mut fde_windows] = [0.0; 2];
        for (n, [ade, fde], futures) in scenes {
            let [far, close] = futures?.collisions;
            collisions = collisions.plus(far, n as f64 / total as f64);
            close_collisions = close_collisions.plus(close, 1.0 / windows);
            ade_windows += ade / n as f64 / windows;
            fde_windows += fde / n as f64 / windows;
        }
        Some(Self { ade_windows, fde_windows, collisions, close_collisions })
    }
}

/// The collisions within the futures of one scene, at each distance of [`TOO_NEAR`].
#[derive(Debug)]
pub(crate) struct SceneFutures {
    collisions: [FutureCollisions; 2],
}

impl SceneFutures {
    /// `best` is the future of JADE.
    pub(crate) fn of(scene: &ScoredWindow<'_>, best: usize) -> Self {
        let (n, forecast) = (scene.pedestrians(), scene.forecast());
        let truth = colliding(n, 1, |i, _| scene.truth(i));
        let forecast = colliding(n, scene.hypotheses(), |i, k| forecast.hypothesis(i, k));
        let share = |count: usize| count as f64 / n as f64;
        let of_distance = |d: usize| FutureCollisions {
            mean: share(forecast[d].iter().sum()) / forecast[d].len() as f64,
            best: share(forecast[d][best]),
            truth: share(truth[d][0]),
        };
        Self { collisions: [of_distance(0), of_distance(1)] }
    }
}

/// Number of pedestrians that come too near to another, at each distance of [`TOO_NEAR`], in each future: `[2][K]`.
///
/// Only pairs whose surroundings overlap are compared, found by a sweep along x.
fn colliding<'a>(n: usize, futures: usize, path: impl Fn(usize, usize) -> &'a [Position]) -> [Vec<usize>; 2] {
    // No path is empty.
    let around = |path: &[Position]| bounds(path.iter().copied()).unwrap_or_default();
    let boxes: Vec<Vec<[Position; 2]>> = (0..n).map(|i| (0..futures).map(|k| around(path(i, k))).collect()).collect();
    let whole: Vec<[Position; 2]> = boxes.iter().map(|boxes| around(boxes.as_flattened())).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| whole[a][0][0].total_cmp(&whole[b][0][0]));
    let mut hit = TOO_NEAR.map(|_| vec![false; n * futures]);
    for (at, &i) in order.iter().enumerate() {
        for j in order[at + 1..].iter().copied().take_while(|&j| whole[j][0][0] < whole[i][1][0] + TOO_NEAR[0]) {
            if far_apart(whole[i], whole[j]) {
                continue;
            }
            for k in (0..futures).filter(|&k| !far_apart(boxes[i][k], boxes[j][k])) {
                let apart = closest_approach(path(i, k), path(j, k));
                for (hit, _) in hit.iter_mut().zip(TOO_NEAR).filter(|(_, near)| apart < *near) {
                    hit[k * n + i] = true;
                    hit[k * n + j] = true;
                }
            }
        }
    }
    hit.map(|hit| hit.chunks(n).map(|of_future: &[bool]| of_future.iter().filter(|&&hit| hit).count()).collect())
}

/// Whether no two points within two rectangles, each from its low to its high corner, are too near.
fn far_apart([low, high]: [Position; 2], [other_low, other_high]: [Position; 2]) -> bool {
    (0..2).any(|c| (low[c] - other_high[c]).max(other_low[c] - high[c]) >= TOO_NEAR[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three walk side by side, 0.22 to 0.5 m apart, or far apart in their second future; four stand in pairs, 0.35 m
    /// and 0.18 m apart.
    #[test]
    fn who_comes_too_near_is_counted_at_each_distance_in_each_future() {
        let along = |x: f64, y: f64| (0..12).map(|t| [x, y + 0.2 * f64::from(t)]).collect::<Vec<_>>();
        let paths = [[0.3, 0.0], [0.0, 0.1], [0.4, -0.2]].map(|[x, y]| [along(x, y), along(50.0 * x, 40.0 * y)]);
        assert_eq!(colliding(3, 2, |i, k| paths[i][k].as_slice()), [vec![3, 0], vec![0, 0]]);
        let standing = [[0.0, 0.0], [0.0, -0.35], [0.15, 9.0], [0.0, 9.1]];
        assert_eq!(colliding(4, 1, |i, _| &standing[i..=i]), [vec![4], vec![2]]);
    }
}
