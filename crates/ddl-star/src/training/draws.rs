//! The random draws of training steps: noise, rotations and seeds, for many steps at once.

use crate::StarError;
use crate::model::tensor;
use crate::training::schedule::Schedule;
use ddl_data::Rotation;
use ddl_network::seed::{Stage, stream};
use rand::{Rng as _, RngExt as _};
use rand_distr::StandardNormal;
use std::ops::Range;
use tch::{Device, Kind, Tensor};

/// The random draws of consecutive steps, copied to the device at once, so that no step has to wait.
#[derive(Debug)]
pub(crate) struct StepDraws {
    steps: Range<u64>,
    seeds: Vec<Seeds>,
    /// `[steps, noise]`.
    noise: Tensor,
    /// `[steps, 2, 2]`, the images of the axes; `None` without rotation and mirroring.
    turns: Option<Tensor>,
}

#[derive(Debug, Clone, Copy)]
struct Seeds {
    libtorch: i64,
    kernels: u64,
}

#[derive(Debug)]
pub(crate) struct StepDraw {
    /// Seed of libtorch's generator.
    pub(crate) libtorch: i64,
    /// Seed of the kernels' dropout.
    pub(crate) kernels: u64,
    /// The noise vector that all pedestrians and frames share, `[1, noise]`.
    pub(crate) noise: Tensor,
    /// The images of the axes under the step's rotation and mirror, `[2, 2]`.
    pub(crate) turn: Option<Tensor>,
}

impl StepDraws {
    /// Draws for `steps`; rotations and reflections if `turned` and `mirrored`.
    pub(crate) fn new(
        steps: Range<u64>,
        schedule: &Schedule,
        (turned, mirrored): (bool, bool),
        noise_width: i64,
        device: Device,
        kind: Kind,
    ) -> Result<Self, StarError> {
        let mut seeds = Vec::new();
        let mut noise: Vec<f64> = Vec::new();
        let mut turns = Vec::new();
        for step in steps.clone() {
            let mut rng = stream(schedule.seed(), Stage::Step, step);
            let libtorch = (rng.next_u64() >> 1).cast_signed();
            noise.extend((0..noise_width).map(|_| rng.sample::<f64, _>(StandardNormal)));
            let kernels = rng.next_u64();
            seeds.push(Seeds { libtorch, kernels });
            if turned || mirrored {
                let rotation = if turned {
                    schedule.rotation(step)
                } else {
                    Rotation::new(0.0)
                };
                let side = if mirrored && rng.random::<bool>() { -1.0 } else { 1.0 };
                turns.extend(rotation.apply([1.0, 0.0]));
                turns.extend(rotation.apply([0.0, side]));
            }
        }
        let count = seeds.len() as i64;
        let tensor = |values: &[f64], shape: &[i64]| tensor(values, shape, (kind, device));
        let turns = if turned || mirrored {
            Some(tensor(&turns, &[count, 2, 2])?)
        } else {
            None
        };
        Ok(Self {
            steps,
            seeds,
            noise: tensor(&noise, &[count, noise_width])?,
            turns,
        })
    }

    /// The draws of a step; `None` for a step outside of these draws.
    pub(crate) fn at(&self, step: u64) -> Option<StepDraw> {
        let index = step.checked_sub(self.steps.start)?;
        let seeds = self.seeds.get(index as usize)?;
        let row = index as i64;
        Some(StepDraw {
            libtorch: seeds.libtorch,
            kernels: seeds.kernels,
            noise: self.noise.narrow(0, row, 1),
            turn: self.turns.as_ref().map(|turns| turns.get(row)),
        })
    }

    /// Sets the noise of a step to NaN.
    #[cfg(test)]
    pub(crate) fn spoil(&mut self, step: u64) {
        let row = (step - self.steps.start) as i64;
        let _ = self.noise.narrow(0, row, 1).fill_(f64::NAN);
    }
}
