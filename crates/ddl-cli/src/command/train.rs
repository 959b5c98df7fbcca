//! `ddl train`.

use super::{Machine, Telling, dataset};
use crate::interrupt::Interrupt;
use crate::progress::Progress;
use clap::Args;
use ddl::data::Convention;
use ddl::goal::GoalEstimatorParams;
use ddl::star::{LearningRateSchedule, TrainingConfig};
use ddl::{RunDirectory, TrainingRequest, Variant};
use std::path::PathBuf;

/// Train a model on all scenes but one; resumes where an earlier run of the same command stopped
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  ddl train --fold eth --epochs 10 --out runs/eth")]
pub(crate) struct Train {
    /// Data convention: star, social-gan or simulated
    #[arg(long, default_value = "star")]
    convention: Convention,
    /// Folder of the recordings [default: `$DDL_DATASETS`, then `datasets/eth_ucy`]
    #[arg(long)]
    data: Option<PathBuf>,
    /// Scene left out of training: eth, hotel, univ, zara1 or zara2; of the simulated ones corridor,
    /// crossing, plaza, bottleneck or doorway
    #[arg(long)]
    fold: String,
    /// full, no-goal-shift, no-dynamics or star (neither)
    #[arg(long, default_value = "full")]
    variant: Variant,
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Epochs
    #[arg(long, default_value_t = 200)]
    epochs: usize,
    /// Walkers an epoch, going round the training set [default: all]
    #[arg(long = "train-walkers")]
    walkers_per_epoch: Option<usize>,
    /// Walkers a batch; the published 256 learns slowly on few epochs
    #[arg(long, default_value_t = 256)]
    batch_walkers: usize,
    /// Largest step size of Adam
    #[arg(long, default_value_t = 1.5e-3)]
    learning_rate: f64,
    /// How the step size changes: constant (as published) or cosine
    #[arg(long, default_value = "constant")]
    learning_rate_schedule: LearningRateSchedule,
    /// Share of the training recordings' time, at their ends, kept for validation
    #[arg(long, default_value_t = 0.0)]
    validation: f64,
    /// Directory of the run
    #[arg(long)]
    out: PathBuf,
    #[command(flatten)]
    machine: Machine,
    #[command(flatten)]
    telling: Telling,
}

impl Train {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        self.machine.prepare()?;
        let interrupt = Interrupt::catch()?;
        let dataset = dataset(self.convention, self.data.as_deref())?;
        let request = TrainingRequest {
            fold: self.fold,
            variant: self.variant,
            training: TrainingConfig {
                epochs: self.epochs,
                walkers_per_epoch: self.walkers_per_epoch,
                batch_walkers: self.batch_walkers,
                learning_rate: self.learning_rate,
                learning_rate_schedule: self.learning_rate_schedule,
                seed: self.seed,
                ..TrainingConfig::default()
            },
            validation: self.validation,
            goals: GoalEstimatorParams::default().seed(self.seed),
            out: RunDirectory::new(self.out),
            device: self.machine.device,
            commit: self.telling.commit,
        };
        let progress = Progress::new("train", self.telling.progress);
        ddl::train(&request, &dataset, |now| {
            let (done, total) = now.steps;
            let (epoch, loss) = (now.step.epoch, now.step.loss);
            progress.tell(done, total, &format!("epoch {epoch} loss {loss:.4}"));
            interrupt.flow()
        })?;
        Ok(())
    }
}
