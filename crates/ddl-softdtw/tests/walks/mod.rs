//! Synthetic pedestrians.

#![allow(dead_code, reason = "each program needs a part")]

use ddl_softdtw::SoftDtw;

pub(crate) type Track<const D: usize> = Vec<[f64; D]>;

pub(crate) fn dtw_of(gamma: f64) -> SoftDtw {
    SoftDtw::new(gamma).expect("valid")
}

pub(crate) fn mapped(tracks: &[Track<2>], scale: f64, by: f64) -> Vec<Track<2>> {
    let map = |step: &[f64; 2]| step.map(|v| v * scale + by);
    tracks.iter().map(|t| t.iter().map(map).collect()).collect()
}

/// A stream of numbers in [0, 1): splitmix64.
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Velocities (m/s) of a pedestrian that keeps its heading with some noise, and stands still in some steps.
    pub(crate) fn pedestrian<const D: usize>(&mut self, steps: usize) -> Track<D> {
        let mean: [f64; D] = std::array::from_fn(|_| 2.0 * self.next() - 1.0);
        let stop = (self.next() * 2.0 * steps as f64) as usize;
        let mut swaying = |mean: f64| mean + 0.3 * (self.next() - 0.5);
        let velocity = |step: usize| {
            let stands = (stop..stop + 12).contains(&step);
            mean.map(|mean| if stands { 0.0 } else { swaying(mean) })
        };
        (0..steps).map(velocity).collect()
    }

    /// Velocities of a standing pedestrian: half of them exactly 0, the others multiples of 1 mm/s.
    pub(crate) fn standing(&mut self, steps: usize) -> Track<2> {
        let height = if self.next() < 0.5 { 0.0 } else { 4.0 };
        let mut jitter = || (self.next() * height).floor() * 1e-3;
        (0..steps).map(|_| [jitter(), jitter()]).collect()
    }
}
