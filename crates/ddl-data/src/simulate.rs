//! Simulated crowds: a social-force model, for machines without real recordings.
//!
//! Each pedestrian accelerates towards its desired velocity, brakes and turns aside to avoid collisions, keeps away
//! from walls, and stays with its group (Helbing and Molnár, Phys. Rev. E 51 (1995); Moussaïd et al., Proc. R. Soc. B
//! 276 (2009), and `PLoS` ONE 5 (2010)). Desired speeds are drawn from N(1.34, 0.26) m/s. Arrivals are a Poisson
//! process of single pedestrians, pairs and groups of three; some stop for a while. The integration step is 0.05 s, the
//! sampling interval 0.4 s.
//!
//! Accuracy measured on a simulated crowd does not transfer to real pedestrians.

mod engine;
mod force;
mod layout;
mod obstacle;
mod pedestrian;
mod population;
mod vector;

#[cfg(test)]
mod tests;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::recording::Recording;
use crate::simulate::engine::FRAME_STEP;
use crate::simulate::layout::SCENES;

/// Recorded steps of a scene: three minutes.
const STEPS: i64 = 450;

/// Three minutes of each scene. The same seed gives the same bytes.
pub(crate) fn recordings(seed: u64) -> Vec<Recording> {
    let recordings = (0..).zip(SCENES).map(|(stream, (name, layout))| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        let observations = engine::run(&layout(), STEPS, &mut rng);
        // Cannot fail: pedestrians have unique ids and are seen once a frame, capped speeds keep positions finite, and
        // there are many arrivals in three minutes.
        Recording::new(name, FRAME_STEP, observations).expect("a simulation yields unique, finite observations")
    });
    recordings.collect()
}
