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
mod scene;
mod vector;

#[cfg(test)]
mod tests;

use ddl_core::PedestrianId;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::recording::Recording;
use crate::simulate::engine::FRAME_STEP;
use crate::simulate::layout::SceneLayout;
pub(crate) use crate::simulate::scene::CrowdScene;

/// Recorded steps of a scene: three minutes.
const STEPS: i64 = 450;

impl CrowdScene {
    /// Simulates three minutes of the scene. The same seed gives the same bytes.
    pub(crate) fn simulate(self, seed: u64) -> Crowd {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(self as u64);
        let layout = SceneLayout::of(self);
        let trace = engine::run(&layout, STEPS, &mut rng);
        // Cannot fail: pedestrians have unique ids and are seen once a frame, capped speeds keep positions finite, and
        // there are many arrivals in three minutes.
        let recording = Recording::new(self.name(), FRAME_STEP, trace.observations)
            .expect("a simulation yields unique, finite observations");
        let groups = trace.groups;
        Crowd { recording, groups }
    }
}

/// A simulated recording with its groups.
pub(crate) struct Crowd {
    pub(crate) recording: Recording,
    /// Two or more pedestrians that entered together and stay together.
    #[cfg_attr(not(test), expect(dead_code, reason = "the tests check that groups stay together"))]
    pub(crate) groups: Vec<Vec<PedestrianId>>,
}
