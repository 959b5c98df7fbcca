//! Training of the proposal network, one step at a time.

use crate::StarError;
use crate::device::OneThread;
use crate::model::tensor;
use crate::proposal::augment::augment;
use crate::proposal::data::{Views, rows_of};
use crate::proposal::loss::{LossWeights, winner_takes_all};
use crate::proposal::network::TorchProposals;
use crate::training::GENERATOR;
use crate::training::checkpoint;
use crate::training::optimizer::Adam;
use ddl_core::WorkDone;
use ddl_network::seed::{Stage, stream};
use ddl_network::weights::Origin;
use ddl_network::{LearningRateSchedule, ProposalExample, ProposalStep, ProposalTraining};
use rand::{Rng as _, RngExt as _};
use std::path::Path;
use std::sync::PoisonError;
use tch::Tensor;

/// Name of the running mean of the weights in a saved state.
const AVERAGED: &str = "average";
/// Decay of the running mean of the weights in each step.
const AVERAGE: f64 = 0.999;
/// Decay of the reported distance in each step.
const REPORTED: f64 = 0.98;

#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct ProposalProgress {
    steps: u64,
    distance: f64,
}

/// A proposal network in training: first the proposals from the observation only, then its memory branch, if it has
/// one. A run that was stopped, saved and resumed gives the same weights as an uninterrupted run.
#[derive(Debug)]
pub struct ProposalTrainer {
    network: TorchProposals,
    adam: Adam,
    /// Running mean of the weights, which becomes the result.
    average: Tensor,
    /// Views of the examples, then of the reversed ones.
    views: Views,
    future: Tensor,
    /// Number of examples in the original direction of time.
    onward: usize,
    training: ProposalTraining,
    progress: ProposalProgress,
}

impl ProposalTrainer {
    /// Prepares training on the examples, and on `reversed` ones, whose time runs backwards (may be empty).
    ///
    /// # Errors
    /// [`StarError::Network`] for a bad configuration, [`StarError::NoTrainingWindows`] without examples.
    pub fn new(
        network: TorchProposals,
        examples: &[ProposalExample],
        reversed: &[ProposalExample],
        training: ProposalTraining,
    ) -> Result<Self, StarError> {
        training.check()?;
        if examples.is_empty() {
            return Err(StarError::NoTrainingWindows);
        }
        let (device, kind) = (network.device.0, network.kind);
        let both: Vec<&ProposalExample> = examples.iter().chain(reversed).collect();
        let views = Views::new(both.iter().map(|example| &example.view), &network.config, device, kind)?;
        let future: Vec<f64> = both.iter().flat_map(|example| example.future.as_flattened()).copied().collect();
        let future = tensor(&future, &[both.len() as i64, -1, 2], (kind, device))?;
        Ok(Self {
            adam: Adam::new(network.parameters()),
            average: network.parameters().flat.detach().copy(),
            network,
            views,
            future,
            onward: examples.len(),
            training,
            progress: ProposalProgress::default(),
        })
    }

    /// Steps of both parts.
    pub fn steps(&self) -> WorkDone {
        let memory = self.network.config.memory.as_ref();
        let of_memory = memory.map_or(0, |_| self.training.memory.steps);
        WorkDone { done: self.progress.steps, total: self.training.steps + of_memory }
    }

    /// Whether all steps are done.
    pub fn is_finished(&self) -> bool {
        let WorkDone { done, total } = self.steps();
        done >= total
    }

    /// Ends training and returns the network with the running mean of its weights.
    ///
    /// # Errors
    /// [`StarError::Torch`] when libtorch fails.
    pub fn into_network(self) -> Result<TorchProposals, StarError> {
        let _guard = tch::no_grad_guard();
        let mut flat = self.network.parameters().flat.shallow_clone();
        flat.f_copy_(&self.average)?;
        Ok(self.network)
    }

    /// Saves weights, their mean, the optimiser and the progress to one file.
    ///
    /// # Errors
    /// When the file cannot be written; an earlier one is unchanged.
    pub fn save(&self, origin: &Origin, path: &Path) -> Result<(), StarError> {
        let progress = [self.progress.steps as f64, self.progress.distance];
        let average = [(AVERAGED, &self.average)];
        checkpoint::save(self.network.parameters(), &self.adam, &progress, &average, origin, path)
    }

    /// Continues from a saved state of the same run.
    ///
    /// # Errors
    /// [`StarError::Network`] when the file is of another origin, or not a complete state of this network.
    pub fn resume(&mut self, origin: &Origin, path: &Path) -> Result<(), StarError> {
        let (parameters, most) = (self.network.parameters(), self.steps().total);
        let average = [(AVERAGED, &self.average)];
        let (steps, [_, distance]) = checkpoint::load(parameters, &mut self.adam, &average, most, origin, path)?;
        if let Some(of_memory) = steps.checked_sub(self.training.steps) {
            self.adam.steps = of_memory;
        }
        self.progress = ProposalProgress { steps, distance };
        Ok(())
    }

    /// One batch for every member: forward, backward, clipped Adam step.
    ///
    /// # Errors
    /// [`StarError::ProposalNonFinite`] when the loss or gradient is not finite; the weights are then those before the
    /// step.
    pub fn step(&mut self) -> Result<ProposalStep, StarError> {
        let _one_thread = OneThread::begin();
        let step = self.progress.steps;
        let training = &self.training;
        // Steps of this part of the training: done, and in total.
        let (done, total) = match step.checked_sub(training.steps) {
            None => (step, training.steps),
            Some(done) => (done, training.memory.steps),
        };
        let remembering = step >= training.steps;
        if remembering && done == 0 {
            self.begin_memory_branch()?;
        }
        let training = &self.training;
        let (rows, views, future) = self.batch(step);
        let weights = LossWeights {
            relaxed: training.relaxed_ends_at(done, total),
            waypoints: training.waypoint_weight,
            probability: training.probability_weight,
        };
        let branch = remembering.then(|| self.network.forward_remembering(&views));
        let proposals = branch.flatten().unwrap_or_else(|| self.network.forward(&views));
        let (loss, distance) = winner_takes_all(&proposals, &future, weights);
        let parameters = self.network.parameters();
        let gradient = parameters.gradient_of(&loss)?;
        let norm = gradient.norm();
        let (distance, norm_value) = (distance.double_value(&[]), norm.double_value(&[]));
        self.ensure_finite(step, &rows, [("loss", distance), ("gradient norm", norm_value)])?;
        let rate = training.learning_rate * LearningRateSchedule::Cosine.factor(done, total);
        // Members are trained independently, so the norm of all their gradients grows with the square root of their
        // number.
        let clip = training.gradient_clip * (self.network.config.members as f64).sqrt();
        self.adam.step(parameters, &gradient, &norm, clip, rate);
        let _guard = tch::no_grad_guard();
        // The decay is smaller at first, so that the initial weights are soon forgotten.
        let decay = AVERAGE.min((done as f64 + 1.0) / (done as f64 + 10.0));
        let _ = self.average.lerp_(&parameters.flat.detach(), 1.0 - decay);
        let decay = if done == 0 { 0.0 } else { REPORTED };
        self.progress.distance = decay * self.progress.distance + (1.0 - decay) * distance;
        self.progress.steps += 1;
        Ok(ProposalStep { done: self.progress.steps, distance: self.progress.distance })
    }

    /// Fixes the rest of the network at the mean of its weights. No gradient reaches it, and without moments Adam does
    /// not change it.
    fn begin_memory_branch(&mut self) -> Result<(), StarError> {
        let _guard = tch::no_grad_guard();
        let parameters = self.network.parameters();
        parameters.flat.shallow_clone().f_copy_(&self.average)?;
        self.adam = Adam::new(parameters);
        Ok(())
    }

    fn ensure_finite(&self, step: u64, rows: &Tensor, quantities: [(&'static str, f64); 2]) -> Result<(), StarError> {
        let Some((quantity, value)) = quantities.into_iter().find(|(_, value)| !value.is_finite()) else {
            return Ok(());
        };
        let row = rows.int64_value(&[0, 0]) as usize;
        // The reversed examples come after the others.
        let reversed = row >= self.onward;
        let example = if reversed { row - self.onward } else { row };
        Err(StarError::ProposalNonFinite { step, quantity, value, example, reversed })
    }

    /// The rows `[M, B]` of a step, drawn for each member, and their augmented views and futures.
    fn batch(&self, step: u64) -> (Tensor, Views, Tensor) {
        let mut rng = stream(self.training.seed, Stage::ProposalStep, step);
        let (members, batch) = (self.network.config.members, self.training.batch);
        let (onward, examples) = (self.onward as i64, self.future.size()[0]);
        let reversed = if examples > onward { self.training.reversed } else { 0.0 };
        let rows: Vec<i64> = (0..members * batch)
            .map(|_| {
                let backwards = rng.random::<f64>() < reversed;
                rng.random_range(if backwards { onward..examples } else { 0..onward })
            })
            .collect();
        let rows = Tensor::from_slice(&rows).reshape([members, batch]).to_device(self.future.device());
        let (views, future) = (self.views.rows(&rows), rows_of(&self.future, &rows));
        // Hold the lock from seeding to the last draw.
        let _generator = GENERATOR.lock().unwrap_or_else(PoisonError::into_inner);
        tch::manual_seed((rng.next_u64() >> 1).cast_signed());
        let (views, future) = augment(&views, &future, &self.training);
        (rows, views, future)
    }
}
