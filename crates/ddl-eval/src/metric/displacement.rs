//! Average and final displacement errors, and their minima over the hypotheses.
//!
//! For one pedestrian with the true positions p(t), t = 1..T, and hypothesis k:
//!
//! ```text
//! ADE_k = 1/T sum_t |p_k(t) - p(t)|        FDE_k = |p_k(T) - p(T)|        metres
//! minADE_K = min_k ADE_k    minFDE_K = min_k FDE_k    FDE@minADE_K = FDE_k* with k* = argmin_k ADE_k
//! ADE@minFDE_K = ADE_k* with k* = argmin_k FDE_k
//! expected ADE = sum_k w_k ADE_k            most likely ADE = ADE_k* with k* = argmax_k w_k (the first of equals)
//! JADE = min_k 1/N sum_i ADE_{i,k}          JFDE = min_k 1/N sum_i FDE_{i,k}        one index for all pedestrians
//! goal FDE = min_k |g_k - p(T)|             with the goals g_k
//! ```
//!
//! The two minima are independent; STAR's and DDL's code prints `FDE@minADE`, works that choose by the endpoint
//! (`PECNet`, Y-Net) print `ADE@minFDE`. The expected error is that of a hypothesis that is drawn with the probability
//! of its weight. The protocol `single` scores the [representative](Forecast::representative) hypothesis, not the most
//! likely one. JADE and JFDE suit only models whose hypothesis `k` is one future of the scene: the protocol `joint`. A
//! goal beyond the 12th frame is still compared with the last true position.
//!
//! # References
//! Pellegrini et al., "You'll never walk alone", ICCV 2009 (displacement errors); Gupta et al., "Social GAN", CVPR 2018
//! (best of K); DDL (Wang, Zhi, Batista, Chandra, ICRA 2024), section III-A; Weng et al., "Joint Metrics Matter",
//! ICCV 2023.

use ddl_core::{Forecast, Position, average_displacement, distance};

use crate::scored_window::ScoredWindow;

/// FDE: the distance of the last forecast position from the last true one, metres.
///
/// # Panics
/// When the two differ in length or are empty.
pub(crate) fn final_displacement(forecast: &[Position], truth: &[Position]) -> f64 {
    assert_eq!(forecast.len(), truth.len(), "lengths of forecast and truth");
    distance(forecast[forecast.len() - 1], truth[truth.len() - 1])
}

/// ADE and FDE of every hypothesis of every pedestrian of a scene: two tables `[N][K]`, metres.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplacementErrors {
    hypotheses: usize,
    ade: Vec<f64>,
    fde: Vec<f64>,
}

impl DisplacementErrors {
    /// Measures a scene.
    pub fn of(scene: &ScoredWindow<'_>) -> Self {
        let hypotheses = scene.hypotheses();
        let table = |error: fn(&[Position], &[Position]) -> f64| {
            (0..scene.pedestrians())
                .flat_map(|i| (0..hypotheses).map(move |k| (i, k)))
                .map(|(i, k)| error(scene.forecast().hypothesis(i, k), scene.truth(i)))
                .collect()
        };
        Self { hypotheses, ade: table(average_displacement), fde: table(final_displacement) }
    }

    /// ADE of each hypothesis of pedestrian `i`, metres.
    pub fn ade(&self, i: usize) -> &[f64] {
        &self.ade[i * self.hypotheses..(i + 1) * self.hypotheses]
    }

    /// FDE of each hypothesis of pedestrian `i`, metres.
    pub fn fde(&self, i: usize) -> &[f64] {
        &self.fde[i * self.hypotheses..(i + 1) * self.hypotheses]
    }

    /// minADE of pedestrian `i`, metres.
    pub fn min_ade(&self, i: usize) -> f64 {
        self.ade(i).iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// minFDE of pedestrian `i`, metres: independent of [`min_ade`](Self::min_ade).
    pub fn min_fde(&self, i: usize) -> f64 {
        self.fde(i).iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// FDE of the hypothesis of pedestrian `i` with the smallest ADE (of equal ones, the first), metres.
    pub(crate) fn fde_at_min_ade(&self, i: usize) -> f64 {
        self.fde(i)[least(self.ade(i))]
    }

    /// ADE of the hypothesis of pedestrian `i` with the smallest FDE (of equal ones, the first), metres.
    pub(crate) fn ade_at_min_fde(&self, i: usize) -> f64 {
        self.ade(i)[least(self.fde(i))]
    }

    /// The future of the scene with the least mean ADE, and that with the least mean FDE (of equal ones, the first).
    pub(crate) fn best_futures(&self) -> [usize; 2] {
        self.scene_means().map(|means| least(&means))
    }

    /// JADE and JFDE of the scene, metres; their futures may differ.
    pub(crate) fn joint(&self) -> [f64; 2] {
        self.scene_means().map(|means| means[least(&means)])
    }

    fn scene_means(&self) -> [Vec<f64>; 2] {
        let n = self.ade.len() / self.hypotheses;
        [Self::ade, Self::fde].map(|metric| {
            let mean = |k: usize| (0..n).map(|i| metric(self, i)[k]).sum::<f64>() / n as f64;
            (0..self.hypotheses).map(mean).collect()
        })
    }
}

fn least(errors: &[f64]) -> usize {
    (1..errors.len()).fold(0, |best, k| if errors[k] < errors[best] { k } else { best })
}

/// `sum_k w_k e_k` of pedestrian `i`, metres, for its errors `e`, one for each hypothesis.
///
/// # Panics
/// When `i` is out of range or there are more errors than hypotheses.
pub(crate) fn expected(forecast: &Forecast, i: usize, errors: &[f64]) -> f64 {
    errors.iter().enumerate().map(|(k, error)| forecast.weight(i, k) * error).sum()
}

/// Distance of the nearest goal of pedestrian `i` from the true endpoint, metres; `None` without goals.
pub(crate) fn goal_fde(scene: &ScoredWindow<'_>, i: usize) -> Option<f64> {
    let end = scene.window().end(i)?;
    (0..scene.hypotheses())
        .map(|k| scene.forecast().goal(i, k).map(|goal| distance(goal, end)))
        .try_fold(f64::INFINITY, |least, d| d.map(|d| least.min(d)))
}

pub(crate) fn minus(a: Position, b: Position) -> Position {
    [a[0] - b[0], a[1] - b[1]]
}

/// Angle from one direction to another, degrees; positive to the left, from x to y.
pub(crate) fn turn(from: Position, to: Position) -> f64 {
    let (cross, dot) = (from[0] * to[1] - from[1] * to[0], from[0] * to[0] + from[1] * to[1]);
    cross.atan2(dot).to_degrees()
}
