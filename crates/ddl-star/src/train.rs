//! The training loop, one step at a time, so that the caller decides when to report, save and stop.

use crate::StarError;
use crate::checkpoint::{self, Progress};
use crate::draws::{StepDraw, StepDraws};
use crate::emission::NoiseInput;
use crate::flow::StepRule;
use crate::gate::Gate;
use crate::layers::Mode;
use crate::loss::{mean_distance, mean_squared_distance};
use crate::optimizer::Adam;
use crate::origin::Origin;
use crate::pass::Pass;
use crate::precision::Precision;
use crate::prepared::{PreparedBatches, TrainingBatch};
use crate::schedule::Schedule;
use crate::seed::GENERATOR;
use crate::star::StarNetwork;
use crate::training_config::{Objective, TrainingConfig};
use crate::training_report::{EpochReport, StepReport};
use ddl_data::{HORIZON, OBSERVED, Position, WINDOW, Window};
use std::path::Path;
use std::sync::PoisonError;
use std::time::Instant;
use tch::{Device, Kind, Tensor};

/// Steps whose losses CUDA keeps before they are read.
const READ_EVERY_ON_CUDA: usize = 16;

/// A network in training. Every step draws from its own random stream, so that a run that was
/// stopped, saved and resumed gives the same weights as one that was not.
#[derive(Debug)]
pub struct Trainer {
    network: StarNetwork,
    adam: Adam,
    schedule: Schedule,
    batches: PreparedBatches,
    draws: Option<StepDraws>,
    gate: Gate,
    /// Loss and norm of the gradient of the last steps, `[2]` each, not read yet.
    unread: Vec<Tensor>,
    read_every: usize,
    config: TrainingConfig,
    progress: Progress,
}

impl Trainer {
    /// Prepares training of `network` on `windows`, each with its future.
    ///
    /// # Errors
    /// [`StarError::Config`] for a bad configuration or a network in bf16, [`StarError::NoTrainingWindows`] when no
    /// window has a future.
    pub fn new(
        network: StarNetwork,
        windows: Vec<Window>,
        config: TrainingConfig,
    ) -> Result<Self, StarError> {
        let lessons = windows.into_iter().filter(Window::has_future).collect();
        Self::of(network, lessons, None, config)
    }

    /// Prepares training of `network` on `windows`, whose walkers are led to `goals` instead of their true ends.
    ///
    /// # Shapes
    /// `goals[w][i]` is that of pedestrian i of window w, metres.
    ///
    /// # Errors
    /// As [`new`](Self::new); [`StarError::Shape`] when the goals do not fit the windows.
    pub fn towards(
        network: StarNetwork,
        windows: Vec<Window>,
        goals: Vec<Vec<Position>>,
        config: TrainingConfig,
    ) -> Result<Self, StarError> {
        let walkers: Vec<usize> = windows.iter().map(Window::len).collect();
        let given: Vec<usize> = goals.iter().map(Vec::len).collect();
        if given != walkers {
            let first = walkers.iter().zip(&given).position(|(a, b)| a != b);
            let (expected, got) = match first {
                Some(w) => (
                    format!("{} goals, one a walker, of window {w}", walkers[w]),
                    format!("{}", given[w]),
                ),
                None => (
                    format!("the goals of {} windows", walkers.len()),
                    format!("those of {}", given.len()),
                ),
            };
            return Err(StarError::Shape {
                operation: "training",
                expected,
                got,
            });
        }
        let (windows, goals) = windows
            .into_iter()
            .zip(goals)
            .filter(|(window, _)| window.has_future())
            .unzip();
        Self::of(network, windows, Some(goals), config)
    }

    fn of(
        network: StarNetwork,
        windows: Vec<Window>,
        goals: Option<Vec<Vec<Position>>>,
        config: TrainingConfig,
    ) -> Result<Self, StarError> {
        config.check()?;
        config.check_for(network.config().variant)?;
        if network.precision() != Precision::F32 {
            return Err(StarError::Config {
                field: "precision",
                value: network.precision().name().to_owned(),
                rule: "f32 in training",
            });
        }
        let schedule = Schedule::new(&windows, &config);
        if schedule.is_empty() {
            return Err(StarError::NoTrainingWindows);
        }
        let batches = PreparedBatches::new(
            (windows, goals),
            schedule.batches(),
            network.config().neighbour_box,
            network.device(),
            network.kind(),
        );
        let gate = Gate::new(network.device(), network.kind());
        let read_every = match network.device() {
            Device::Cpu => 1,
            _ => READ_EVERY_ON_CUDA,
        };
        Ok(Self {
            adam: Adam::new(network.parameters()),
            network,
            schedule,
            batches,
            draws: None,
            gate,
            unread: Vec::new(),
            read_every,
            config,
            progress: Progress::default(),
        })
    }

    /// The network as trained so far.
    pub fn network(&self) -> &StarNetwork {
        &self.network
    }

    /// Ends training and hands the network over. On CUDA, losses not read yet are never looked at: end at the
    /// end of an epoch, or [`save`](Self::save) first.
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
    /// When the file cannot be written; an earlier one is then left as it was. [`StarError::NonFinite`] as in
    /// [`step`](Self::step).
    pub fn save(&mut self, origin: &Origin, path: &Path) -> Result<(), StarError> {
        self.read()?;
        checkpoint::save_training(
            self.network.parameters(),
            &self.adam,
            self.progress,
            origin,
            path,
        )
    }

    /// Goes on from a saved state of the same run.
    ///
    /// # Errors
    /// [`StarError::Checkpoint`] when the file is of another origin, or not a whole state of this network.
    pub fn resume(&mut self, origin: &Origin, path: &Path) -> Result<(), StarError> {
        let (_, total) = self.steps();
        let parameters = self.network.parameters();
        self.progress = checkpoint::load_training(parameters, &mut self.adam, total, origin, path)?;
        self.unread.clear();
        self.gate.reopen();
        Ok(())
    }

    /// One batch: forward, backward, clipped Adam step.
    ///
    /// Nothing is read back from the device but what [`StepReport::loss`] says. That a step changes nothing
    /// when its loss is no longer a number is decided on the device, and so does no later one; the
    /// next reading finds out.
    ///
    /// # Errors
    /// [`StarError::NonFinite`] when loss or gradient of this step, or of one since the last reading, is no longer a
    /// number. The weights and the steps done are then those before that step.
    pub fn step(&mut self) -> Result<StepReport, StarError> {
        let started = Instant::now();
        let step = self.progress.steps;
        let draw = self.draw(step)?;
        let batch = self.batch(step, &draw)?;
        let (loss, pass) = {
            // Held from seeding to the last draw of dropout.
            let _generator = GENERATOR.lock().unwrap_or_else(PoisonError::into_inner);
            tch::manual_seed(draw.libtorch);
            let batch = if self.config.jitter > 0.0 {
                batch.jittered(self.config.jitter)
            } else {
                batch
            };
            let pass = Pass::training(Mode::Train, draw.kernels, self.network.parameters());
            (self.loss(&batch, draw.noise, &pass)?, pass)
        };
        let gradient = pass.gradient(&loss, self.network.parameters())?;
        let norm = gradient.norm();
        let both = Tensor::f_stack(&[loss.detach(), norm.shallow_clone()], 0)?;
        self.gate.watch(&both);
        let (_, total) = self.steps();
        let config = &self.config;
        let rate = config.learning_rate * config.learning_rate_schedule.factor(step, total);
        self.adam.step(
            self.network.parameters(),
            &gradient,
            &norm,
            config.gradient_clip,
            rate,
            &self.gate,
        );
        self.unread.push(both);
        self.progress.steps += 1;
        let epoch_ends = self
            .progress
            .steps
            .is_multiple_of(self.schedule.steps_per_epoch() as u64);
        let loss = if epoch_ends || self.unread.len() >= self.read_every {
            self.read()?
        } else {
            None
        };
        self.progress.seconds += started.elapsed().as_secs_f64();
        Ok(self.report(step, loss))
    }

    /// Reads the losses that are not read yet: their mean, if there are any. Waits for the device.
    ///
    /// # Errors
    /// [`StarError::NonFinite`] for the first step that has none; training is then back before that step.
    fn read(&mut self) -> Result<Option<f64>, StarError> {
        let unread = std::mem::take(&mut self.unread);
        if unread.is_empty() {
            return Ok(None);
        }
        let numbers = Tensor::f_stack(&unread, 0)?
            .f_to_device(Device::Cpu)?
            .f_to_kind(Kind::Double)?
            .f_reshape([-1])?;
        let numbers: Vec<f64> = Vec::try_from(numbers)?;
        let (pairs, _) = numbers.as_chunks::<2>();
        let mut sum = 0.0;
        for (&[loss, norm], left) in pairs.iter().zip((1..=pairs.len() as u64).rev()) {
            let bad = [("loss", loss), ("gradient norm", norm)]
                .into_iter()
                .find(|(_, value)| !value.is_finite());
            if let Some((quantity, value)) = bad {
                self.progress.steps -= left;
                self.adam.set_steps(self.progress.steps);
                self.gate.reopen();
                return Err(self.non_finite(quantity, value));
            }
            self.progress.loss_sum += loss;
            sum += loss;
        }
        Ok(Some(sum / pairs.len() as f64))
    }

    /// Loss of a batch.
    fn loss(&self, batch: &TrainingBatch, noise: Tensor, pass: &Pass) -> Result<Tensor, StarError> {
        let (scenes, goals) = (&batch.scenes, &batch.goals);
        let after = |frames: usize| {
            let count = (WINDOW - frames) as i64;
            scenes.positions().f_narrow(0, frames as i64, count)
        };
        match self.config.objective {
            Objective::NextStep => {
                let noise = NoiseInput::Draws(noise);
                let forecast = self.network.teacher_forced_in(scenes, goals, &noise, pass);
                Ok(mean_squared_distance(&forecast, &after(1)?))
            }
            Objective::Walk => {
                let (goals, steps) = (goals.unsqueeze(0), (HORIZON, StepRule::Bounded));
                let noise = NoiseInput::Expected;
                let walk = self
                    .network
                    .roll_out_in(scenes, &goals, &noise, steps, pass);
                Ok(mean_distance(
                    &walk.positions.squeeze_dim(1),
                    &after(OBSERVED)?,
                ))
            }
        }
    }

    /// The batch of a step, turned as it draws.
    fn batch(&self, step: u64, draw: &StepDraw) -> Result<TrainingBatch, StarError> {
        let index = self.schedule.batch_index(step);
        let batch = self.batches.batch(index, self.schedule.batch(index))?;
        Ok(match &draw.turn {
            Some(images) => batch.turned(images),
            None => batch.shared(),
        })
    }

    /// What a step draws, drawn with all that is left of its epoch.
    fn draw(&mut self, step: u64) -> Result<StepDraw, StarError> {
        loop {
            if let Some(draw) = self.draws.as_ref().and_then(|draws| draws.at(step)) {
                return Ok(draw);
            }
            let epoch = self.schedule.steps_per_epoch() as u64;
            self.draws = Some(StepDraws::new(
                step..(step / epoch + 1) * epoch,
                &self.schedule,
                (self.config.rotate, self.config.mirror),
                self.network.config().noise_width,
                self.network.device(),
                self.network.kind(),
            )?);
        }
    }

    /// What is said when the next step is the one at fault.
    fn non_finite(&self, quantity: &'static str, value: f64) -> StarError {
        let batch = self.schedule.batch_index(self.progress.steps);
        let windows = self
            .schedule
            .batch(batch)
            .first()
            .map_or_else(String::new, |&index| {
                let window = self.batches.window(index);
                format!(
                    "{}@{} and following",
                    window.recording(),
                    window.start_frame()
                )
            });
        let epoch = self.completed_epochs() + 1;
        StarError::NonFinite {
            epoch,
            batch,
            quantity,
            value,
            windows,
        }
    }

    fn report(&mut self, step: u64, loss: Option<f64>) -> StepReport {
        let steps_per_epoch = self.schedule.steps_per_epoch();
        let epoch = (step / steps_per_epoch as u64) as usize + 1;
        let done = (step % steps_per_epoch as u64) as usize + 1;
        let finished_epoch = (done == steps_per_epoch).then(|| {
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
        StepReport {
            epoch,
            done,
            steps_per_epoch,
            loss,
            finished_epoch,
        }
    }
}

#[cfg(test)]
#[path = "train_tests.rs"]
mod tests;
