//! Familiarity: how similar an observed motion is to the training motions of a model.
//!
//! Five features describe a motion, and the Mahalanobis distance measures how far it is from the training motions.
//! Familiarity is the share of held-out training motions that are at least as far. Beyond all of them it falls
//! exponentially. It also falls exponentially with the speed beyond the fastest training motions. Standing pedestrians
//! widen the distribution of log speeds so much that the distance alone would hardly detect a runner.

use ddl_core::{OBSERVED, Position, Window};
use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

/// Number of features of a motion.
const FEATURES: usize = 5;
/// Intervals of equal probability that the distances of held-out motions are divided into.
const PARTS: usize = 100;
/// Consecutive motions that are held out, or not: neighbours in the library show the same pedestrian.
const BLOCK: usize = 100;
/// One block in this many is held out.
const HELD_OUT_EVERY: usize = 5;
/// Excess of speed (m/s) over the fastest training motions that reduces familiarity by a factor e.
const EXCESS_SPEED: f64 = 1.0;
/// Lower bound, so that familiarity is never 0.
const LEAST: f64 = 1e-9;
/// Below this familiarity the user is warned: fewer than one in a hundred training motions are as unusual.
pub const UNFAMILIAR_THRESHOLD: f64 = 0.01;

/// Speeds (m/s) and lengths (m) below which logarithms carry little information.
const SPEED: f64 = 0.1;
const LENGTH: f64 = 0.005;

/// The statistics of the training motions that familiarity needs, without tracks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TrainingMotions {
    mean: [f64; FEATURES],
    /// The inverse of the covariance, row by row.
    precision: [[f64; FEATURES]; FEATURES],
    /// Distances of held-out motions in ascending order, from the least to the largest.
    distances: Vec<f64>,
    /// Mean speed (m/s) that one in a thousand exceeds. The largest could be an error that joins two pedestrians into
    /// one.
    fastest: f64,
}

impl TrainingMotions {
    /// Learns from tracks whose first 8 positions (m) are `time_step` seconds apart; `None` for too few or too similar
    /// tracks.
    pub(crate) fn learn(tracks: &[Vec<Position>], time_step: f64) -> Option<Self> {
        let features = |track: &Vec<Position>| features(track.get(..OBSERVED)?, time_step);
        let motions_of_all: Vec<SVector<f64, FEATURES>> = tracks.iter().map(features).collect::<Option<_>>()?;
        if motions_of_all.is_empty() {
            return None;
        }
        let (mut learned, mut apart) = (Vec::new(), Vec::new());
        for (block, motions) in motions_of_all.chunks(BLOCK).enumerate() {
            let to = if block % HELD_OUT_EVERY == HELD_OUT_EVERY - 1 { &mut apart } else { &mut learned };
            to.extend_from_slice(motions);
        }
        let apart = if apart.is_empty() { &learned } else { &apart };
        let count = learned.len() as f64;
        let mean = learned.iter().sum::<SVector<f64, FEATURES>>() / count;
        let spread = learned.iter().map(|x| (x - mean) * (x - mean).transpose());
        let covariance = spread.sum::<SMatrix<f64, FEATURES, FEATURES>>() / count;
        // Keeps the covariance invertible if all motions agree in a feature.
        let covariance = covariance + SMatrix::identity() * 1e-6;
        let precision = covariance.try_inverse()?;
        let mut speeds: Vec<f64> = motions_of_all.iter().map(mean_speed).collect();
        speeds.sort_by(f64::total_cmp);
        let mut motions = Self {
            mean: mean.into(),
            precision: std::array::from_fn(|i| std::array::from_fn(|j| precision[(i, j)])),
            distances: Vec::new(),
            fastest: speeds[(speeds.len() - 1) * 999 / 1000],
        };
        let mut distances: Vec<f64> = apart.iter().map(|x| motions.distance(x)).collect();
        distances.sort_by(f64::total_cmp);
        let last = distances.len().checked_sub(1)?;
        motions.distances = (0..=PARTS).map(|part| distances[part * last / PARTS]).collect();
        motions.is_valid().then_some(motions)
    }

    /// The familiarity of each pedestrian of a window; 1 if its motion or the training motions are unknown.
    pub(crate) fn of_window(motions: Option<&Self>, window: &Window, time_step: f64) -> Vec<f64> {
        let familiarity = |i: usize| {
            let known = motions.filter(|_| !window.quality(i).is_hardly_observed());
            known.map_or(1.0, |motions| motions.familiarity(window.observed(i), time_step))
        };
        (0..window.len()).map(familiarity).collect()
    }

    /// Whether its numbers are possible.
    pub(crate) fn is_valid(&self) -> bool {
        self.mean.iter().chain(self.precision.as_flattened()).chain(&self.distances).all(|x| x.is_finite())
            && (0.0..f64::INFINITY).contains(&self.fastest)
            && self.distances.len() == PARTS + 1
            && self.distances.is_sorted()
    }

    /// The familiarity of an observed motion (m), in (0, 1].
    pub(crate) fn familiarity(&self, observed: &[Position], time_step: f64) -> f64 {
        let Some(features) = features(observed, time_step) else {
            return LEAST;
        };
        let distance = self.distance(&features);
        if !distance.is_finite() {
            return LEAST;
        }
        let largest = self.distances[PARTS];
        let tail = 1.0 / PARTS as f64;
        let share = if distance >= largest {
            tail * (largest - distance).exp()
        } else {
            let above = self.distances.partition_point(|&d| d <= distance).max(1);
            let [from, to] = [self.distances[above - 1], self.distances[above]];
            let part = if to > from { ((distance - from) / (to - from)).max(0.0) } else { 0.0 };
            let below = ((above - 1) as f64 + part) / PARTS as f64;
            (1.0 - below) * (1.0 - tail) + tail
        };
        let faster = (mean_speed(&features) - self.fastest).max(0.0) / EXCESS_SPEED;
        (share * (-faster).exp()).clamp(LEAST, 1.0)
    }

    fn distance(&self, features: &SVector<f64, FEATURES>) -> f64 {
        let off = features - SVector::from(self.mean);
        let precision = SMatrix::from_fn(|i, j| self.precision[i][j]);
        off.dot(&(precision * off)).max(0.0).sqrt()
    }
}

/// The mean speed (m/s) of a motion with these features.
fn mean_speed(features: &SVector<f64, FEATURES>) -> f64 {
    features[0].exp() - SPEED
}

/// The features of a motion; `None` for fewer than 5 positions, or if their distances overflow.
fn features(observed: &[Position], time_step: f64) -> Option<SVector<f64, FEATURES>> {
    let way = |a: Position, b: Position| [b[0] - a[0], b[1] - a[1]];
    let length = |[x, y]: [f64; 2]| x.hypot(y);
    let steps: Vec<[f64; 2]> = observed.array_windows().map(|&[a, b]| way(a, b)).collect();
    let (first, last) = (*observed.first()?, *observed.last()?);
    let half = observed.len() / 2;
    if half < 2 {
        return None;
    }
    let speed = |way: [f64; 2], steps: usize| length(way) / (steps as f64 * time_step);
    let mean = steps.iter().map(|&step| speed(step, 1)).sum::<f64>() / steps.len() as f64;
    let changes = steps.array_windows().map(|&[a, b]| length(way(a, b)));
    let tremble = changes.clone().sum::<f64>() / changes.len() as f64;
    let relative = |a: f64, b: f64| ((a + 2.0 * SPEED) / (b + 2.0 * SPEED)).ln();
    let before = speed(way(first, observed[half]), half);
    let middle = observed.len() - 1 - half;
    let after = speed(way(observed[middle], last), half);
    let straight = speed(way(first, last), steps.len()) / (mean + SPEED);
    let features = SVector::from([
        (mean + SPEED).ln(),
        (tremble + LENGTH).ln(),
        relative(speed(*steps.last()?, 1), mean),
        relative(after, before),
        straight,
    ]);
    features.iter().all(|x| x.is_finite()).then_some(features)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;

    /// `tests/reference/familiarity.py` draws the same motions, 0.5 s apart.
    #[test]
    fn statistics_and_familiarity_are_those_of_numpy() {
        #[derive(Deserialize)]
        struct Reference {
            motions: TrainingMotions,
            probes: Vec<Vec<Position>>,
            familiarity: Vec<f64>,
        }
        let text = include_str!("../../tests/reference/familiarity.json");
        let expected: Reference = serde_json::from_str(text).unwrap();
        let mut state = 7_u64;
        let mut pair = |scale: f64| {
            [(); 2].map(|()| {
                state = (state * 1_103_515_245 + 12_345) % (1 << 31);
                scale * (state as f64 / f64::from(1_u32 << 31) - 0.5)
            })
        };
        let mut motion = || -> Vec<Position> {
            let (velocity, change) = (pair(2.0), pair(0.2));
            let place = |t: f64, noise: Position| [0, 1].map(|c| velocity[c] * t + 0.5 * t * t * change[c] + noise[c]);
            (0..9).map(|t| place(f64::from(t), pair(0.03))).collect()
        };
        let tracks: Vec<_> = (0..1234).map(|_| motion()).collect();
        let found = TrainingMotions::learn(&tracks, 0.5).unwrap();
        let numbers = |m: &TrainingMotions| [&m.mean, m.precision.as_flattened(), &m.distances, &[m.fastest]].concat();
        let familiarity = expected.probes.iter().map(|probe| found.familiarity(probe, 0.5));
        let jump = |far: f64| std::array::from_fn::<Position, 8, _>(|t| [0.0, if t == 4 { far } else { 0.0 }]);
        assert!([1e3, 1e6, 1e200].iter().all(|&far| (found.familiarity(&jump(far), 0.5) / LEAST - 1.0).abs() < 1e-9));
        let found: Vec<f64> = numbers(&found).into_iter().chain(familiarity).collect();
        let expected = [numbers(&expected.motions), expected.familiarity].concat();
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-7 * expected.abs() + 1e-12, "{found} {expected}");
        }
        assert_eq!(TrainingMotions::learn(&[], 0.4), None);
    }
}
