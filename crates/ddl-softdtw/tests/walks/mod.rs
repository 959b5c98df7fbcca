//! Synthetic pedestrians.

#![allow(dead_code, reason = "each program needs a part")]

use ddl_softdtw::SoftDtw;
use fastrand::Rng;

pub(crate) type RandomTrack<const D: usize> = Vec<[f64; D]>;

pub(crate) fn dtw_of(gamma: f64) -> SoftDtw {
    SoftDtw::new(gamma).expect("valid")
}

pub(crate) fn mapped(tracks: &[RandomTrack<2>], scale: f64, by: f64) -> Vec<RandomTrack<2>> {
    let map = |step: &[f64; 2]| step.map(|v| v * scale + by);
    tracks.iter().map(|t| t.iter().map(map).collect()).collect()
}

/// A stream of numbers.
pub(crate) struct RandomNumbers(Rng);

impl RandomNumbers {
    pub(crate) fn seeded(seed: u64) -> Self {
        Self(Rng::with_seed(seed))
    }

    /// Velocities (m/s) of a pedestrian that keeps its heading with some noise, and stands still in some steps.
    pub(crate) fn pedestrian<const D: usize>(&mut self, steps: usize) -> RandomTrack<D> {
        let mean: [f64; D] = std::array::from_fn(|_| 2.0 * self.0.f64() - 1.0);
        let stop = (self.0.f64() * 2.0 * steps as f64) as usize;
        let mut swaying = |mean: f64| mean + 0.3 * (self.0.f64() - 0.5);
        let velocity = |step: usize| {
            let stands = (stop..stop + 12).contains(&step);
            mean.map(|mean| if stands { 0.0 } else { swaying(mean) })
        };
        (0..steps).map(velocity).collect()
    }

    /// Velocities of a standing pedestrian: half of them exactly 0, the others multiples of 1 mm/s.
    pub(crate) fn standing(&mut self, steps: usize) -> RandomTrack<2> {
        let height = if self.0.f64() < 0.5 { 0.0 } else { 4.0 };
        let mut jitter = || (self.0.f64() * height).floor() * 1e-3;
        (0..steps).map(|_| [jitter(), jitter()]).collect()
    }
}
