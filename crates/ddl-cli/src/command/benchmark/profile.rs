//! The amount of work of each profile.

use crate::command::benchmark::pace::TaskPace;
use crate::command::recipe::Recipe;
use clap::ValueEnum;
use ddl::network::{LearningRateSchedule, TrainingConfig};
use serde::{Deserialize, Serialize};
use std::fmt;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Profile {
    /// A test of the whole chain in a minute; its numbers mean nothing
    Smoke,
    /// Numbers worth reading, in minutes
    Quick,
    /// Every window and all epochs of the recipe: half an hour on two cores for each seed; with the protocol
    /// published (200 epochs) some hours, or one GPU
    Paper,
}

impl fmt::Display for Profile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.to_possible_value().ok_or(fmt::Error)?.get_name())
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ProfileWork {
    /// Number of folds: the first ones of the convention.
    pub(super) folds: usize,
    pub(super) proposal_steps: Option<u64>,
    pub(super) test_pedestrians: Option<usize>,
    pub(crate) epochs: usize,
    pub(super) train_pedestrians: Option<usize>,
    pub(super) optimiser: Option<Optimiser>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Optimiser {
    pub(super) batch_pedestrians: usize,
    pub(super) learning_rate: f64,
    pub(super) schedule: LearningRateSchedule,
}

impl Optimiser {
    fn published() -> Self {
        let training = TrainingConfig::published();
        Self {
            batch_pedestrians: training.batch_pedestrians,
            learning_rate: training.learning_rate,
            schedule: training.learning_rate_schedule,
        }
    }

    /// Small batches and step sizes that decay: the best of single-step training within a few thousand steps. Chosen on
    /// validation splits of training recordings.
    fn short() -> Self {
        Self { batch_pedestrians: 16, learning_rate: 1e-3, schedule: LearningRateSchedule::Cosine }
    }
}

impl Profile {
    /// Seconds of one core (AMD EPYC), mean over the folds; only their ratios count. Those of the published recipe are
    /// computed from the time of a step (docs/published.md) and of the scores of zara1 (320 s).
    pub(super) fn pace(self, recipe: Recipe) -> TaskPace {
        match (recipe, self) {
            (Recipe::Recommended, Self::Smoke) => TaskPace::of_seconds(24.0, 4.0, 10.0),
            (Recipe::Recommended, Self::Quick) => TaskPace::of_seconds(243.0, 29.0, 22.0),
            (Recipe::Recommended, Self::Paper) => TaskPace::of_seconds(243.0, 58.0, 65.0),
            (Recipe::Published, Self::Smoke | Self::Quick) => TaskPace::of_seconds(0.0, 180.0, 210.0),
            (Recipe::Published, Self::Paper) => TaskPace::of_seconds(0.0, 10_000.0, 980.0),
        }
    }

    pub(crate) fn work(self, recipe: Recipe) -> ProfileWork {
        let (folds, test_pedestrians) = match self {
            Self::Smoke => (2, Some(150)),
            Self::Quick => (5, Some(2500)),
            Self::Paper => (5, None),
        };
        let (epochs, train_pedestrians, optimiser) = match (recipe, self) {
            (Recipe::Recommended, Self::Smoke) => (1, Some(600), None),
            (Recipe::Recommended, Self::Quick) => (10, None, None),
            // The recommended recipe has 20 epochs.
            (Recipe::Recommended, Self::Paper) => (20, None, None),
            (Recipe::Published, Self::Smoke) => (1, Some(600), Some(Optimiser::published())),
            (Recipe::Published, Self::Quick) => (10, Some(4000), Some(Optimiser::short())),
            (Recipe::Published, Self::Paper) => (200, None, Some(Optimiser::published())),
        };
        ProfileWork {
            folds,
            // The published recipe has no network of goals.
            proposal_steps: ((recipe, self) == (Recipe::Recommended, Self::Smoke)).then_some(40),
            test_pedestrians,
            epochs,
            train_pedestrians,
            optimiser,
        }
    }
}
