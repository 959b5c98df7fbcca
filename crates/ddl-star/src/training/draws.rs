//! The random draws of a training step: seeds, noise and rotation.

use crate::StarError;
use crate::model::{TorchNetwork, tensor};
use crate::training::schedule::Schedule;
use ddl_core::Rotation;
use ddl_network::TrainingConfig;
use ddl_network::seed::{Stage, stream};
use rand::{Rng as _, RngExt as _};
use rand_distr::StandardNormal;
use tch::Tensor;

#[derive(Debug)]
pub(crate) struct StepDraw {
    /// Seed of libtorch's generator.
    pub(crate) libtorch: i64,
    /// Seed of the kernels' dropout.
    pub(crate) kernels: u64,
    /// The noise vector that all pedestrians and frames share, `[1, noise]`.
    pub(crate) noise: Tensor,
    /// The images of the axes under the step's rotation and mirror, `[2, 2]`; `None` without either.
    pub(crate) turn: Option<Tensor>,
}

impl StepDraw {
    /// The same draws in other tensors.
    #[cfg(target_os = "linux")]
    pub(crate) fn copied(&self) -> Self {
        Self { noise: self.noise.copy(), turn: self.turn.as_ref().map(Tensor::copy), ..*self }
    }

    /// Takes the numbers of another step into the same tensors.
    #[cfg(target_os = "linux")]
    pub(crate) fn set(&mut self, other: &Self) -> Result<(), StarError> {
        self.noise.f_copy_(&other.noise)?;
        if let (Some(turn), Some(other)) = (&mut self.turn, &other.turn) {
            turn.f_copy_(other)?;
        }
        Ok(())
    }

    /// The draws of a step, which depend on the seed and the number of the step alone.
    pub(crate) fn new(
        step: u64,
        schedule: &Schedule,
        config: &TrainingConfig,
        network: &TorchNetwork,
    ) -> Result<Self, StarError> {
        let options = (network.kind, network.device);
        let mut rng = stream(schedule.seed, Stage::Step, step);
        let libtorch = (rng.next_u64() >> 1).cast_signed();
        let width = network.layers.config.noise_width;
        let noise: Vec<f64> = (0..width).map(|_| rng.sample(StandardNormal)).collect();
        let kernels = rng.next_u64();
        let turn = (config.rotate || config.mirror).then(|| {
            let rotation = if config.rotate { schedule.rotation(step) } else { Rotation::new(0.0) };
            let side = if config.mirror && rng.random::<bool>() { -1.0 } else { 1.0 };
            [rotation.apply([1.0, 0.0]), rotation.apply([0.0, side])]
        });
        let turn = turn.map(|images| tensor(images.as_flattened(), &[2, 2], options));
        Ok(Self { libtorch, kernels, noise: tensor(&noise, &[1, width], options)?, turn: turn.transpose()? })
    }
}
