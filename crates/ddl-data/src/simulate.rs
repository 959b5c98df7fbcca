//! Simulated crowds: a social-force model, for machines without real recordings.
//!
//! Each pedestrian accelerates towards its desired velocity, brakes and turns aside to avoid collisions, keeps away
//! from walls, and stays with its group (Helbing and Molnár, Phys. Rev. E 51 (1995); Moussaïd et al., Proc. R. Soc. B
//! 276 (2009), and `PLoS` ONE 5 (2010)). Desired speeds are drawn from N(1.34, 0.26) m/s. Arrivals are a Poisson
//! process of single pedestrians, pairs and groups of three; some stop for a while. The integration step is 0.05 s, the
//! sampling interval 0.4 s.
//!
//! Accuracy measured on a simulated crowd does not transfer to real pedestrians.
//!
//! ```
//! let crowd = ddl_data::simulate::CrowdScene::Plaza.simulate(7);
//! assert!(crowd.recording.pedestrians().len() > 50 && !crowd.groups.is_empty());
//! ```

mod engine;
mod force;
mod layout;
mod obstacle;
mod pedestrian;
mod population;
mod scene;
mod vector;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

pub use obstacle::{Pillar, Wall};
pub use scene::CrowdScene;

use crate::recording::Recording;
use ddl_core::PedestrianId;
use engine::FRAME_STEP;
use layout::SceneLayout;

/// Recorded steps of a scene: three minutes.
const STEPS: i64 = 450;

impl CrowdScene {
    /// Simulates three minutes of the scene. The same seed gives the same bytes.
    #[must_use]
    #[expect(clippy::missing_panics_doc, reason = "the comment shows that no seed panics")]
    pub fn simulate(self, seed: u64) -> Crowd {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(self as u64);
        let layout = SceneLayout::of(self);
        let trace = engine::run(&layout, STEPS, &mut rng);
        // Cannot fail: pedestrians have unique ids and are seen once a frame, capped speeds keep positions finite, and
        // there are many arrivals in three minutes.
        let recording = Recording::new(self.name(), FRAME_STEP, trace.observations)
            .expect("a simulation yields unique, finite observations");
        let SceneLayout { walls, pillars, .. } = layout;
        Crowd {
            recording,
            walls,
            pillars,
            groups: trace.groups,
        }
    }
}

/// A simulated recording with its ground truth: walls and groups.
#[derive(Debug, Clone, PartialEq)]
pub struct Crowd {
    /// The positions of all pedestrians.
    pub recording: Recording,
    /// The scene's walls.
    pub walls: Vec<Wall>,
    /// The scene's pillars.
    pub pillars: Vec<Pillar>,
    /// Groups of two or more pedestrians that entered together and stay together.
    pub groups: Vec<Vec<PedestrianId>>,
}
