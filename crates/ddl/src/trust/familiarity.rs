//! Familiarity: how similar an observed motion is to the training motions of a model.
//!
//! Five features describe a motion, and the Mahalanobis distance measures how far it is from the training motions.
//! Familiarity is the share of held-out training motions that are at least as far. Beyond all of them it falls
//! exponentially. It also falls exponentially with the speed beyond the fastest training motions. Standing pedestrians
//! widen the distribution of log speeds so much that the distance alone would hardly detect a runner.

use ddl_data::{OBSERVED, Position, Window};
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
            let to = if block % HELD_OUT_EVERY == HELD_OUT_EVERY - 1 {
                &mut apart
            } else {
                &mut learned
            };
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

    /// The familiarity of each pedestrian of a window; 1 if the training motions are unknown.
    pub(crate) fn of_window(motions: Option<&Self>, window: &Window, time_step: f64) -> Vec<f64> {
        let familiarity = |i: usize| motions.map_or(1.0, |m| m.familiarity(window.observed(i), time_step));
        (0..window.len()).map(familiarity).collect()
    }

    /// Whether its numbers are possible.
    pub(crate) fn is_valid(&self) -> bool {
        let numbers = self.mean.iter().chain(self.precision.as_flattened());
        numbers.chain(&self.distances).all(|x| x.is_finite())
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
            let part = if to > from {
                ((distance - from) / (to - from)).max(0.0)
            } else {
                0.0
            };
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
    use proptest::prelude::*;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;

    /// Paths of 0.3 to 1.8 m/s with noise of up to 5 cm.
    fn tracks() -> Vec<Vec<Position>> {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut draw = || random.random::<f64>();
        (0..4000)
            .map(|_| {
                let (speed, tremble) = (0.3 + 1.5 * draw(), 0.05 * draw());
                (0..20)
                    .map(|t| {
                        [
                            0.4 * speed * f64::from(t) + tremble * (draw() - 0.5),
                            tremble * (draw() - 0.5),
                        ]
                    })
                    .collect()
            })
            .collect()
    }

    /// A share p of motions like those of training has a familiarity below p.
    #[test]
    fn familiarity_is_calibrated() {
        let tracks = tracks();
        let motions = TrainingMotions::learn(&tracks[..3000], 0.4).unwrap();
        let familiarity = |track: &Vec<Position>| motions.familiarity(&track[..OBSERVED], 0.4);
        for level in [0.05, 0.2, 0.5, 0.8] {
            let below = tracks[3000..].iter().filter(|track| familiarity(track) < level).count();
            let share = below as f64 / 1000.0;
            assert!((share - level).abs() < 0.05, "{share} below {level}");
        }
    }

    #[test]
    fn runners_and_jumps_are_unfamiliar() {
        let motions = TrainingMotions::learn(&tracks(), 0.4).unwrap();
        let walk = |speed: f64| {
            (0..8)
                .map(|t| [0.4 * speed * f64::from(t), 0.01 * f64::from(t % 2)])
                .collect::<Vec<_>>()
        };
        let familiar = motions.familiarity(&walk(1.0), 0.4);
        let runners = [4.0, 6.0, 8.0].map(|speed| motions.familiarity(&walk(speed), 0.4));
        assert!(
            familiar > 0.1 && runners[0] < UNFAMILIAR_THRESHOLD && runners.is_sorted_by(|a, b| a > b),
            "{familiar} {runners:?}"
        );
        let mut jump = walk(1.0);
        jump[7][1] += 8.0;
        assert!(motions.familiarity(&jump, 0.4) < UNFAMILIAR_THRESHOLD);
        assert!(motions.familiarity(&[[1e200, 0.0]; 8], 0.4) > 0.0);
        assert_eq!(TrainingMotions::learn(&[], 0.4), None);
    }

    proptest! {
        /// Familiarity is in (0, 1] for every finite motion, and changes little with the speed.
        #[test]
        fn familiarity_is_a_smooth_share(
            track in prop::collection::vec([-1e6..1e6f64, -1e6..1e6f64], 8),
            speed in 0.0..12.0f64,
        ) {
            let motions = TrainingMotions::learn(&tracks(), 0.4).unwrap();
            let share = motions.familiarity(&track, 0.4);
            prop_assert!(share > 0.0 && share <= 1.0);
            let position = |speed: f64, t: i32| [0.4 * speed * f64::from(t), 0.02 * f64::from(t % 2)];
            let walk = |speed: f64| (0..8).map(|t| position(speed, t)).collect::<Vec<_>>();
            let step = (motions.familiarity(&walk(speed), 0.4) - motions.familiarity(&walk(speed + 1e-3), 0.4)).abs();
            prop_assert!(step < 0.05, "{step}");
        }
    }
}
