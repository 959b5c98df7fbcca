//! A crowd that crosses a square of 20 m. A new pedestrian replaces each one that leaves.
#![allow(unreachable_pub, reason = "a module of several tests")]

use ddl_core::{PedestrianId, Position};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

pub type Pedestrians = Vec<(PedestrianId, Position)>;

pub struct Crowd {
    rng: ChaCha8Rng,
    next_id: i64,
    pedestrians: Vec<Pedestrian>,
}

struct Pedestrian {
    id: i64,
    position: Position,
    heading: f64,
    stride: f64,
    steps_left: usize,
}

impl Crowd {
    pub fn new(seed: u64, count: usize) -> Self {
        let mut crowd = Self { rng: ChaCha8Rng::seed_from_u64(seed), next_id: 0, pedestrians: Vec::new() };
        for _ in 0..count {
            let mut pedestrian = crowd.pedestrian();
            pedestrian.steps_left = 1 + (crowd.random() * 40.0) as usize;
            crowd.pedestrians.push(pedestrian);
        }
        crowd
    }

    /// A random number in 0..1.
    pub fn random(&mut self) -> f64 {
        self.rng.random()
    }

    fn pedestrian(&mut self) -> Pedestrian {
        self.next_id += 1;
        let side = (self.random() * 4.0).floor() * std::f64::consts::FRAC_PI_2;
        let along = 16.0 * (self.random() - 0.5);
        let (sin, cos) = side.sin_cos();
        Pedestrian {
            id: self.next_id,
            position: [-10.0 * cos - along * sin, -10.0 * sin + along * cos],
            heading: side + 0.8 * (self.random() - 0.5),
            stride: 0.4 * (1.0 + 0.6 * self.random()),
            steps_left: 25 + (self.random() * 30.0) as usize,
        }
    }

    /// All pedestrians one step of 0.4 s later.
    pub fn step(&mut self) -> Pedestrians {
        for index in 0..self.pedestrians.len() {
            let turn = 0.1 * (self.random() - 0.5);
            let pedestrian = &mut self.pedestrians[index];
            pedestrian.heading += turn;
            pedestrian.position[0] += pedestrian.stride * pedestrian.heading.cos();
            pedestrian.position[1] += pedestrian.stride * pedestrian.heading.sin();
            pedestrian.steps_left -= 1;
            if pedestrian.steps_left == 0 {
                self.pedestrians[index] = self.pedestrian();
            }
        }
        self.pedestrians.iter().map(|pedestrian| (PedestrianId(pedestrian.id), pedestrian.position)).collect()
    }
}
