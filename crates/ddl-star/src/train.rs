//! The training loop, one step at a time, so that the caller decides when to report, save and stop.

use crate::StarError;
use crate::batch::SceneBatch;
use crate::checkpoint::{self, Progress};
use crate::layers::Mode;
use crate::loss::mean_squared_distance;
use crate::optimizer::Adam;
use crate::pass::Pass;
use crate::schedule::Schedule;
use crate::seed::{GENERATOR, Stage, stream};
use crate::star::{NoiseInput, StarNetwork};
use crate::training_config::TrainingConfig;
use ddl_data::{WINDOW, Window};
use rand::{Rng as _, RngExt as _};
use rand_distr::StandardNormal;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::PoisonError;
use std::time::Instant;
use tch::Tensor;

/// What one step did.
#[derive(Debug, Clone, PartialEq)]
pub struct StepReport {
    /// Epoch of the step, counted from 1.
    pub epoch: usize,
    /// Steps done in that epoch, this one included.
    pub done: usize,
    /// Steps of an epoch.
    pub steps_per_epoch: usize,
    /// Loss of the batch, square metres.
    pub loss: f64,
    /// Set when the step was the last of its epoch.
    pub finished_epoch: Option<EpochReport>,
}

/// One line of `metrics.jsonl`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EpochReport {
    /// Counted from 1.
    pub epoch: usize,
    /// Mean of the batches' losses, square metres.
    pub loss: f64,
    /// Batches of the epoch.
    pub batches: usize,
    /// Seconds it took.
    pub seconds: f64,
}

/// A network in training. Every step draws from its own random stream, so that a run that was
/// stopped, saved and resumed gives the same weights as one that was not.
#[derive(Debug)]
pub struct Trainer {
    network: StarNetwork,
    adam: Adam,
    schedule: Schedule,
    windows: Vec<Window>,
    config: TrainingConfig,
    progress: Progress,
}

impl Trainer {
    /// Prepares training of `network` on `windows`, each with its future.
    ///
    /// # Errors
    /// [`StarError::Config`] for a bad configuration, [`StarError::NoTrainingWindows`] when no
    /// window has a future.
    pub fn new(
        network: StarNetwork,
        windows: Vec<Window>,
        config: TrainingConfig,
    ) -> Result<Self, StarError> {
        config.check()?;
        let windows: Vec<Window> = windows.into_iter().filter(Window::has_future).collect();
        let schedule = Schedule::new(&windows, &config);
        if schedule.is_empty() {
            return Err(StarError::NoTrainingWindows);
        }
        let adam = Adam::new(network.parameters());
        Ok(Self {
            network,
            adam,
            schedule,
            windows,
            config,
            progress: Progress::default(),
        })
    }

    /// The network as trained so far.
    pub fn network(&self) -> &StarNetwork {
        &self.network
    }

    /// Ends training and hands the network over.
    #[must_use]
    pub fn into_network(self) -> StarNetwork {
        self.network
    }

    /// Whether all epochs are done.
    pub fn is_finished(&self) -> bool {
        self.completed_epochs() >= self.config.epochs
    }

    /// Whole epochs done.
    pub fn completed_epochs(&self) -> usize {
        (self.progress.steps / self.schedule.steps_per_epoch() as u64) as usize
    }

    /// Steps done, over all epochs, and steps in all.
    pub fn steps(&self) -> (u64, u64) {
        let total = self.schedule.steps_per_epoch() * self.config.epochs;
        (self.progress.steps, total as u64)
    }

    /// Saves weights, optimiser and progress to one file.
    ///
    /// # Errors
    /// When the file cannot be written; an earlier one is then left as it was.
    pub fn save(&self, path: &Path) -> Result<(), StarError> {
        checkpoint::save_training(self.network.parameters(), &self.adam, self.progress, path)
    }

    /// Goes on from a saved state of the same run.
    ///
    /// # Errors
    /// [`StarError::Checkpoint`] when the file is not a whole state of this network.
    pub fn resume(&mut self, path: &Path) -> Result<(), StarError> {
        self.progress = checkpoint::load_training(self.network.parameters(), &mut self.adam, path)?;
        Ok(())
    }

    /// One batch: forward, backward, clipped Adam step.
    ///
    /// # Errors
    /// [`StarError::NonFinite`] when loss or gradient is no longer a number; the weights are then
    /// those before the step.
    pub fn step(&mut self) -> Result<StepReport, StarError> {
        let started = Instant::now();
        let step = self.progress.steps;
        let batch = self.batch(step)?;
        let (loss, pass) = {
            // Held from seeding to the last draw of dropout.
            let _generator = GENERATOR.lock().unwrap_or_else(PoisonError::into_inner);
            let (noise, seed) = self.draw(step);
            let pass = Pass::taped(Mode::Train, seed).in_precision(self.network.precision());
            (self.loss(&batch, &noise, &pass)?, pass)
        };
        let value = loss.double_value(&[]);
        self.require_finite("loss", value)?;
        let gradient = pass.gradient(&loss, self.network.parameters())?;
        let norm = gradient.norm();
        self.require_finite("gradient norm", norm.double_value(&[]))?;
        let (_, total) = self.steps();
        let config = &self.config;
        let rate = config.learning_rate * config.learning_rate_schedule.factor(step, total);
        self.adam.step(
            self.network.parameters(),
            &gradient,
            &norm,
            config.gradient_clip,
            rate,
        );
        self.progress.steps += 1;
        self.progress.loss_sum += value;
        self.progress.seconds += started.elapsed().as_secs_f64();
        Ok(self.report(step, value))
    }

    /// Loss of a batch with the true ends as goals (the goal estimator is never used in training).
    fn loss(
        &self,
        batch: &SceneBatch,
        noise: &NoiseInput,
        pass: &Pass,
    ) -> Result<Tensor, StarError> {
        let goals = batch.positions().f_get(WINDOW as i64 - 1)?;
        let forecast = self.network.teacher_forced_in(batch, &goals, noise, pass);
        let truth = batch.positions().f_narrow(0, 1, WINDOW as i64 - 1)?;
        Ok(mean_squared_distance(&forecast, &truth))
    }

    fn batch(&self, step: u64) -> Result<SceneBatch, StarError> {
        let indices = self.schedule.batch(self.schedule.batch_index(step));
        let windows: Vec<&Window> = indices.iter().map(|&index| &self.windows[index]).collect();
        let batch = SceneBatch::new(
            &windows,
            WINDOW,
            WINDOW - 1,
            self.network.config().neighbour_box,
            self.network.device(),
            self.network.kind(),
        )?;
        let turn = self.config.rotate;
        Ok(if turn {
            batch.rotated(self.schedule.rotation(step))
        } else {
            batch
        })
    }

    /// The step's noise vector, shared by all walkers and frames; also seeds its dropout.
    fn draw(&self, step: u64) -> (NoiseInput, u64) {
        let mut rng = stream(self.config.seed, Stage::Step, step);
        tch::manual_seed((rng.next_u64() >> 1).cast_signed());
        let width = self.network.config().noise_width as usize;
        let noise: Vec<f64> = (0..width).map(|_| rng.sample(StandardNormal)).collect();
        let noise = Tensor::from_slice(&noise)
            .unsqueeze(0)
            .to_kind(self.network.kind())
            .to_device(self.network.device());
        (NoiseInput::Draws(noise), rng.next_u64())
    }

    fn require_finite(&self, quantity: &'static str, value: f64) -> Result<(), StarError> {
        if value.is_finite() {
            return Ok(());
        }
        let batch = self.schedule.batch_index(self.progress.steps);
        let windows = self
            .schedule
            .batch(batch)
            .first()
            .map_or_else(String::new, |&index| {
                let window = &self.windows[index];
                format!(
                    "{}@{} and following",
                    window.recording(),
                    window.start_frame()
                )
            });
        let epoch = self.completed_epochs() + 1;
        Err(StarError::NonFinite {
            epoch,
            batch,
            quantity,
            value,
            windows,
        })
    }

    fn report(&mut self, step: u64, loss: f64) -> StepReport {
        let steps_per_epoch = self.schedule.steps_per_epoch();
        let epoch = (step / steps_per_epoch as u64) as usize + 1;
        let done = (step % steps_per_epoch as u64) as usize + 1;
        let finished_epoch = (done == steps_per_epoch).then(|| {
            let report = EpochReport {
                epoch,
                loss: self.progress.loss_sum / steps_per_epoch as f64,
                batches: steps_per_epoch,
                seconds: self.progress.seconds,
            };
            (self.progress.loss_sum, self.progress.seconds) = (0.0, 0.0);
            report
        });
        StepReport {
            epoch,
            done,
            steps_per_epoch,
            loss,
            finished_epoch,
        }
    }
}
