//! The loss of a batch, and its gradient with respect to all learned numbers as one vector.

use crate::StarError;
use crate::model::{KernelPass, Layers, NoiseInput, TensorEngine, TorchBackend, TorchNetwork};
use crate::training::draws::StepDraw;
use crate::training::loss::{mean_distance, mean_squared_distance};
use crate::training::prepared::TrainingBatch;
use ddl_core::{OBSERVED, WINDOW};
use ddl_network::backend::{Kernels, Mode};
use ddl_network::seed::{Stage, stream};
use ddl_network::{Objective, StepRule};
use rand::Rng as _;
use rayon::prelude::*;
use std::sync::Arc;
use tch::Tensor;

/// By libtorch, whose generator draws the dropout.
pub(crate) fn by_torch(
    network: &TorchNetwork,
    objective: Objective,
    batch: &TrainingBatch,
    noise: Tensor,
) -> Result<(Tensor, Tensor), StarError> {
    let parameters = network.parameters();
    let torch = TorchBackend::training(parameters, Mode::Train);
    let loss = loss(&network.layers, objective, batch, noise, TensorEngine::Torch(&torch))?;
    let gradient = torch.gradient(&loss, parameters)?;
    Ok((loss, gradient))
}

/// By kernels, the parts on several threads. The result does not depend on the number of threads.
pub(crate) fn by_kernels(
    network: &TorchNetwork,
    kernels: &Arc<Kernels>,
    objective: Objective,
    parts: Vec<TrainingBatch>,
    draw: &StepDraw,
) -> Result<(Tensor, Tensor), StarError> {
    let (layers, count) = (&network.layers, network.parameters().layout().count());
    let pedestrians: usize = parts.iter().map(|part| part.scenes.pedestrians()).sum();
    let jobs = parts.into_iter().zip(0..).map(|(part, index)| {
        let seed = seed_of_part(draw.kernels, index);
        (part, seed, draw.noise.shallow_clone(), network.copy_noise_weight())
    });
    let gradients: Vec<Result<(Tensor, Vec<f32>), StarError>> = jobs
        .collect::<Vec<_>>()
        .into_par_iter()
        .map(|(part, seed, noise, noise_weight)| {
            let pass = KernelPass::new(kernels, Mode::Train, seed, noise_weight);
            let share = part.scenes.pedestrians() as f64 / pedestrians as f64;
            let loss = loss(layers, objective, &part, noise, TensorEngine::Kernels(&pass))? * share;
            let gradient = pass.gradient(&loss, layers, count)?;
            Ok((loss.detach(), gradient))
        })
        .collect();
    // In the order of the parts, for the same sums with every number of threads.
    let mut sums = vec![0.0; count];
    let mut losses = Vec::new();
    for of_part in gradients {
        let (loss, gradient) = of_part?;
        losses.push(loss);
        for (sum, term) in sums.iter_mut().zip(gradient) {
            *sum += term;
        }
    }
    let loss = Tensor::f_stack(&losses, 0)?.f_sum(None)?;
    Ok((loss, Tensor::f_from_slice(&sums)?))
}

/// The seed of a part's dropout. That of the first part is the seed of the step.
fn seed_of_part(of_step: u64, part: u64) -> u64 {
    match part {
        0 => of_step,
        part => stream(of_step, Stage::Step, part).next_u64(),
    }
}

/// The mean loss of the pedestrians of a batch, in a pass.
fn loss(
    layers: &Layers,
    objective: Objective,
    batch: &TrainingBatch,
    noise: Tensor,
    pass: TensorEngine<'_>,
) -> Result<Tensor, StarError> {
    let (scenes, goals) = (&batch.scenes, &batch.goals);
    let after = |frames: usize| {
        let count = (WINDOW - frames) as i64;
        scenes.positions.f_narrow(0, frames as i64, count)
    };
    match objective {
        Objective::NextStep => {
            let noise = NoiseInput::Draws(noise);
            let forecast = layers.teacher_forced(scenes, goals, &noise, pass);
            Ok(mean_squared_distance(&forecast, &after(1)?))
        }
        Objective::Walk => {
            let goals = goals.unsqueeze(0);
            let walk = layers.roll_out(scenes, &goals, &NoiseInput::Expected, StepRule::Bounded, pass);
            Ok(mean_distance(&walk.positions.squeeze_dim(1), &after(OBSERVED)?))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_has_its_own_dropout() {
        let mut seeds: Vec<u64> = (0..40).map(|index| seed_of_part(index / 20, index % 20)).collect();
        assert_eq!([seeds[0], seeds[20]], [0, 1]);
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 40);
    }
}
