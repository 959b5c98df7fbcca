//! The training loop, one step at a time, so that the caller decides when to report, save and stop.

use crate::StarError;
use crate::model::TorchNetwork;
use crate::training::GENERATOR;
use crate::training::checkpoint::{self, TrainerProgress};
use crate::training::draws::StepDraw;
use crate::training::gradient;
use crate::training::optimizer::Adam;
use crate::training::prepared::{PreparedBatches, TrainingBatch};
#[cfg(target_os = "linux")]
use crate::training::recorded::RecordedSteps;
use crate::training::schedule::Schedule;
use ddl_core::{OBSERVED, Position, Window, WorkDone};
use ddl_network::backend::Kernels;
use ddl_network::weights::{Origin, Weights};
use ddl_network::{EpochReport, NetworkError, StepReport, TrainingConfig};
use std::path::Path;
use std::sync::Arc;
use std::sync::PoisonError;
use std::time::Instant;
use tch::Tensor;

/// Least mean number of pedestrians in the parts of a batch. On the CPU, several threads compute the parts, and their
/// gradients are added. Smaller parts take more processor time.
const PART: usize = 128;
/// The origin of a window is a multiple of this, metres.
const ORIGIN_SPACING: f64 = 1024.0;

/// A network in training. A run that was stopped, saved and resumed gives the same weights as an uninterrupted run.
#[derive(Debug)]
pub struct Trainer {
    network: TorchNetwork,
    /// The weights in the form of the kernels, if kernels compute.
    kernels: Option<Arc<Kernels>>,
    adam: Adam,
    schedule: Schedule,
    batches: PreparedBatches,
    /// On a card.
    #[cfg(target_os = "linux")]
    recorded: Option<RecordedSteps>,
    config: TrainingConfig,
    progress: TrainerProgress,
}

impl Trainer {
    /// Prepares training of `network` on `windows`, with `goals` instead of the true endpoints if there are any.
    /// Windows without a future are left out.
    ///
    /// # Shapes
    /// `goals[w][i]` is the goal of pedestrian i of window w, metres.
    ///
    /// # Errors
    /// [`StarError::Network`] for a bad configuration, [`StarError::NoTrainingWindows`] when no window has a future,
    /// [`NetworkError::Shape`] when the goals do not fit the windows.
    pub fn new(
        network: TorchNetwork,
        mut windows: Vec<Window>,
        mut goals: Option<Vec<Vec<Position>>>,
        config: TrainingConfig,
    ) -> Result<Self, StarError> {
        if let Some(goals) = &mut goals {
            check_goals(&windows, goals)?;
            let mut of_windows = windows.iter();
            goals.retain(|_| of_windows.next().is_some_and(Window::has_future));
        }
        windows.retain(Window::has_future);
        // Single precision rounds coordinates of maps to half a metre. Within 512 m of the origin nothing changes.
        for (w, window) in windows.iter_mut().enumerate() {
            let origin = window.observed(0)[OBSERVED - 1].map(|x| ORIGIN_SPACING * (x / ORIGIN_SPACING).round());
            let relative = |position: Position| [0, 1].map(|axis| position[axis] - origin[axis]);
            *window = window.map_positions(|_, _, position| relative(position));
            for goal in goals.iter_mut().flat_map(|goals| &mut goals[w]) {
                *goal = relative(*goal);
            }
        }
        config.check(network.layers.config.variant)?;
        let schedule = Schedule::new(&windows, &config);
        if schedule.batches.is_empty() {
            return Err(StarError::NoTrainingWindows);
        }
        let kernels = network.kernels()?;
        #[cfg(target_os = "linux")]
        let recorded = match network.device {
            tch::Device::Cuda(_) => Some(RecordedSteps::new(schedule.batches.len())?),
            _ => None,
        };
        let batches = PreparedBatches::new(
            (windows, goals),
            schedule.batches.len(),
            network.layers.config.neighbour_box,
            kernels.is_some().then_some(PART),
            (network.device, network.kind),
        );
        Ok(Self {
            adam: Adam::new(network.parameters()),
            kernels,
            network,
            schedule,
            batches,
            #[cfg(target_os = "linux")]
            recorded,
            config,
            progress: TrainerProgress::default(),
        })
    }

    /// A copy of the current weights.
    ///
    /// # Errors
    /// [`StarError::Torch`] when they cannot be fetched from their device.
    pub fn weights(&self) -> Result<Weights, StarError> {
        self.network.parameters().to_weights()
    }

    /// Whether all epochs are done.
    pub fn is_finished(&self) -> bool {
        self.completed_epochs() >= self.config.epochs
    }

    /// Whole epochs done.
    pub fn completed_epochs(&self) -> usize {
        (self.progress.steps / self.schedule.steps_per_epoch as u64) as usize
    }

    /// Steps over all epochs.
    pub fn steps(&self) -> WorkDone {
        WorkDone { done: self.progress.steps, total: (self.schedule.steps_per_epoch * self.config.epochs) as u64 }
    }

    /// Saves weights, optimiser and progress to one file.
    ///
    /// # Errors
    /// When the file cannot be written; an earlier one is unchanged.
    pub fn save(&self, origin: &Origin, path: &Path) -> Result<(), StarError> {
        let of = &self.progress;
        let progress = [of.steps as f64, of.loss_sum, of.seconds];
        checkpoint::save(self.network.parameters(), &self.adam, &progress, &[], origin, path)
    }

    /// Continues from a saved state of the same run.
    ///
    /// # Errors
    /// [`NetworkError::Checkpoint`] when the file is of another origin, or not a complete state of this network.
    pub fn resume(&mut self, origin: &Origin, path: &Path) -> Result<(), StarError> {
        let total = self.steps().total;
        let parameters = self.network.parameters();
        let (steps, [_, loss_sum, seconds]) = checkpoint::load(parameters, &mut self.adam, &[], total, origin, path)?;
        self.progress = TrainerProgress { steps, loss_sum, seconds };
        Ok(())
    }

    /// One batch: forward, backward, clipped Adam step.
    ///
    /// # Errors
    /// [`StarError::NonFinite`] when the loss or its gradient is not finite. The weights and the number of steps are
    /// then those before the step.
    pub fn step(&mut self) -> Result<StepReport, StarError> {
        let started = Instant::now();
        let step = self.progress.steps;
        let draw = StepDraw::new(step, &self.schedule, &self.config, &self.network)?;
        self.update_kernels()?;
        let (loss, gradient) = self.gradient(step, &draw)?;
        let norm = gradient.norm();
        let loss = loss.double_value(&[]);
        self.ensure_finite([("loss", loss), ("gradient norm", norm.double_value(&[]))])?;
        let total = self.steps().total;
        let config = &self.config;
        let rate = config.learning_rate * config.learning_rate_schedule.factor(step, total);
        let parameters = self.network.parameters();
        self.adam.step(parameters, &gradient, &norm, config.gradient_clip, rate);
        self.progress.steps += 1;
        self.progress.loss_sum += loss;
        self.progress.seconds += started.elapsed().as_secs_f64();
        Ok(self.report(step, loss))
    }

    fn update_kernels(&mut self) -> Result<(), StarError> {
        if let Some(kernels) = &mut self.kernels {
            let weights = self.network.parameters().to_weights()?;
            // In place, unless an earlier pass still holds the old weights.
            Arc::make_mut(kernels).update(weights.numbers());
        }
        Ok(())
    }

    /// The loss of a step and its gradient with respect to all learned numbers, as one vector.
    fn gradient(&mut self, step: u64, draw: &StepDraw) -> Result<(Tensor, Tensor), StarError> {
        let index = self.schedule.batch_index(step);
        let parts = self.batches.batch(index, &self.schedule.batches[index])?;
        let network = &self.network;
        let TrainingConfig { objective, jitter, .. } = self.config;
        if self.kernels.is_none() {
            // On several threads, so before the lock.
            for part in parts {
                let _ = part.scenes.seen(0..1);
            }
        }
        // Held until the last draw: of jitter, and in a pass of libtorch of dropout.
        let generator = GENERATOR.lock().unwrap_or_else(PoisonError::into_inner);
        tch::manual_seed(draw.libtorch);
        if let Some(kernels) = &self.kernels {
            let varied: Vec<TrainingBatch> = parts.iter().map(|part| part.varied(draw.turn.as_ref(), jitter)).collect();
            drop(generator);
            return gradient::by_kernels(network, kernels, objective, varied, draw);
        }
        let [batch] = parts else { unreachable!("without kernels, batches are whole") };
        let compute = |draw: &StepDraw| {
            let batch = batch.varied(draw.turn.as_ref(), jitter);
            gradient::by_torch(network, objective, &batch, draw.noise.shallow_clone())
        };
        #[cfg(target_os = "linux")]
        if let Some(recorded) = &mut self.recorded {
            return recorded.gradient(index, draw, compute);
        }
        compute(draw)
    }

    fn ensure_finite(&self, quantities: [(&'static str, f64); 2]) -> Result<(), StarError> {
        let Some((quantity, value)) = quantities.into_iter().find(|(_, value)| !value.is_finite()) else {
            return Ok(());
        };
        let batch = self.schedule.batch_index(self.progress.steps);
        let windows = self.schedule.batches[batch].first().map_or_else(String::new, |&index| {
            let window = self.batches.window(index);
            format!("{}@{} and following", window.recording(), window.start_frame())
        });
        Err(StarError::NonFinite { epoch: self.completed_epochs() + 1, batch, quantity, value, windows })
    }

    fn report(&mut self, step: u64, loss: f64) -> StepReport {
        let steps_per_epoch = self.schedule.steps_per_epoch;
        let epoch = (step / steps_per_epoch as u64) as usize + 1;
        let is_last = (step + 1).is_multiple_of(steps_per_epoch as u64);
        let finished_epoch = is_last.then(|| {
            let report = EpochReport {
                epoch,
                loss: self.progress.loss_sum / steps_per_epoch as f64,
                batches: steps_per_epoch,
                seconds: self.progress.seconds,
                validation: None,
            };
            (self.progress.loss_sum, self.progress.seconds) = (0.0, 0.0);
            report
        });
        StepReport { epoch, loss, finished_epoch }
    }
}

/// Checks that there is one goal for each pedestrian of each window.
fn check_goals(windows: &[Window], goals: &[Vec<Position>]) -> Result<(), NetworkError> {
    if goals.len() != windows.len() {
        let [expected, got] = [windows.len(), goals.len()].map(|count| format!("goals of {count} windows"));
        return Err(NetworkError::shape("training", expected, got));
    }
    let counts = windows.iter().map(Window::len).zip(goals.iter().map(Vec::len));
    match counts.enumerate().find(|(_, (pedestrians, goals))| pedestrians != goals) {
        None => Ok(()),
        Some((w, (pedestrians, goals))) => {
            let expected = format!("{pedestrians} goals for window {w}, one for each pedestrian");
            Err(NetworkError::shape("training", expected, goals.to_string()))
        }
    }
}

#[cfg(test)]
mod tests;
