//! The load: simulated cameras with their pedestrians and frame times.

use ddl::data::{PedestrianId, Position, SceneName};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Seconds from one frame of a camera to the next.
pub(crate) const FRAME: f64 = 0.4;
/// Pedestrians that a camera sees.
pub(crate) const PEDESTRIANS: usize = 12;
/// Pedestrians per square metre, about as many as in the recording `students003`.
const DENSITY: f64 = 0.2;
/// Noise of a position from frame to frame (metres).
const JITTER: f64 = 0.01;

/// A camera over a square, in which pedestrians walk straight and turn back at the walls.
pub(crate) struct Camera {
    pub(crate) name: SceneName,
    /// Delay of its frames, as a share of the time between two frames.
    pub(crate) phase: f64,
    /// Start position (m) and velocity (metres per frame) of each pedestrian.
    walks: Vec<[Position; 2]>,
    random: ChaCha8Rng,
}

impl Camera {
    pub(crate) fn new(number: usize) -> crate::Result<Self> {
        let mut random = ChaCha8Rng::seed_from_u64(number as u64);
        let walk = |_| {
            let start = [0; 2].map(|_| side() * random.random::<f64>());
            let (speed, heading) = (random.random_range(0.5..1.8), TAU * random.random::<f64>());
            let step = FRAME * speed;
            [start, [step * f64::cos(heading), step * f64::sin(heading)]]
        };
        let walks = (0..PEDESTRIANS).map(walk).collect();
        Ok(Self {
            name: SceneName::new(&format!("camera {number}"))?,
            phase: random.random(),
            walks,
            random,
        })
    }

    pub(crate) fn frame(&mut self, frame: i64) -> Vec<(PedestrianId, Position)> {
        let mut position = |(i, [start, step]): (usize, &[Position; 2])| {
            let place = std::array::from_fn(|axis| {
                let way = (start[axis] + step[axis] * frame as f64).rem_euclid(2.0 * side());
                way.min(2.0 * side() - way) + JITTER * (self.random.random::<f64>() - 0.5)
            });
            (PedestrianId(i as i64), place)
        };
        self.walks.iter().enumerate().map(&mut position).collect()
    }
}

fn side() -> f64 {
    (PEDESTRIANS as f64 / DENSITY).sqrt()
}
