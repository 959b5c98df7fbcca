//! Settings of the training.

use crate::NetworkError;
use crate::config::range::{at_least_one, not_negative, positive, require};
use crate::config::variant::Variant;
use ddl_core::named;
use serde::{Deserialize, Serialize};

/// Schedule of Adam's step size over the training.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LearningRateSchedule {
    /// Constant, as published.
    Constant,
    /// Rises over the first twentieth of the training, then falls along a half cosine to zero.
    Cosine,
}

impl LearningRateSchedule {
    const WARM_UP: f64 = 0.05;

    /// Factor (0 to 1) on the largest step size at step `step` of `total`, counted from 0.
    pub fn factor(self, step: u64, total: u64) -> f64 {
        match self {
            Self::Constant => 1.0,
            Self::Cosine => {
                let progress = (step as f64 + 0.5) / total.max(1) as f64;
                let fall = (progress - Self::WARM_UP) / (1.0 - Self::WARM_UP);
                if progress < Self::WARM_UP {
                    progress / Self::WARM_UP
                } else {
                    0.5 * (1.0 + (std::f64::consts::PI * fall.min(1.0)).cos())
                }
            }
        }
    }
}

named!(LearningRateSchedule, "learning-rate schedule", Constant => "constant", Cosine => "cosine");

/// The training objective.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Objective {
    /// Forecast each next position from the true positions before it, with the true endpoint as goal and with noise.
    /// The loss is the squared distance (paper eq. 13).
    NextStep,
    /// Forecast the whole horizon from the observed positions, with an estimated goal. The loss is the distance from
    /// the true path.
    Walk,
}

named!(Objective, "objective", NextStep => "next-step", Walk => "walk");

/// Largest number of epochs, so that the number of training steps fits `u64`.
const MOST_EPOCHS: usize = 1_000_000;

/// Settings of the training.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingConfig {
    /// The objective.
    pub objective: Objective,
    /// Number of passes over the training set (or over `pedestrians_per_epoch` of it).
    pub epochs: usize,
    /// Largest step size of Adam.
    pub learning_rate: f64,
    /// Schedule of the step size.
    pub learning_rate_schedule: LearningRateSchedule,
    /// Largest norm of the gradient.
    pub gradient_clip: f64,
    /// Windows are gathered into a batch until it holds more than this many pedestrians.
    pub batch_pedestrians: usize,
    /// Rotate each batch by a random angle at every visit. The angles of successive visits add up, as published.
    pub rotate: bool,
    /// Mirror each batch at every visit with probability 1/2.
    pub mirror: bool,
    /// Largest standard deviation (metres) of the normal errors that are added to observed coordinates at every visit.
    /// The deviation of each pedestrian is uniform from 0 to this. True futures are not changed. Only for
    /// [`Objective::Walk`].
    pub jitter: f64,
    /// Train on about this many pedestrians in an epoch; the next epoch continues with the windows after them.
    pub pedestrians_per_epoch: Option<usize>,
    /// Seed of initial weights, batch order, rotation, mirror images, jitter, noise and dropout.
    pub seed: u64,
}

impl TrainingConfig {
    /// The paper's training: 200 epochs of one-step forecasts, batches of 256 pedestrians, step size 1.5e-3.
    pub fn published() -> Self {
        Self {
            objective: Objective::NextStep,
            epochs: 200,
            learning_rate: 1.5e-3,
            learning_rate_schedule: LearningRateSchedule::Constant,
            gradient_clip: 1.0,
            batch_pedestrians: 256,
            rotate: true,
            mirror: false,
            jitter: 0.0,
            pedestrians_per_epoch: None,
            seed: 1,
        }
    }

    /// The training behind the protocols `fair` and `single` (`docs/tried.md`).
    pub fn recommended(variant: Variant) -> Self {
        let (objective, jitter) =
            if variant.uses_goal() { (Objective::Walk, 0.06) } else { (Objective::NextStep, 0.0) };
        Self {
            objective,
            epochs: 20,
            learning_rate: 1e-3,
            learning_rate_schedule: LearningRateSchedule::Cosine,
            batch_pedestrians: 64,
            mirror: true,
            jitter,
            pedestrians_per_epoch: Some(5000),
            ..Self::published()
        }
    }

    /// Checks every field, for a network of this variant.
    ///
    /// # Errors
    /// [`NetworkError::Config`] naming the first field that is out of range, or [`Objective::Walk`] for
    /// [`Variant::Star`], which has no goals.
    pub fn check(&self, variant: Variant) -> Result<(), NetworkError> {
        require((1..=MOST_EPOCHS).contains(&self.epochs), "epochs", &self.epochs, "1 to 1000000")?;
        positive("learning_rate", self.learning_rate)?;
        let jitter = self.jitter;
        not_negative("jitter", jitter)?;
        require(
            jitter == 0.0 || self.objective == Objective::Walk,
            "jitter",
            &jitter,
            "0 unless the objective is walk: the targets of next-step include observed positions",
        )?;
        positive("gradient_clip", self.gradient_clip)?;
        at_least_one("batch_pedestrians", self.batch_pedestrians as u64)?;
        let pedestrians = self.pedestrians_per_epoch.unwrap_or(1);
        at_least_one("pedestrians_per_epoch", pedestrians as u64)?;
        require(
            variant.uses_goal() || self.objective == Objective::NextStep,
            "objective",
            &"walk",
            "next-step for the variant without goals",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cosine_schedule_rises_then_falls_to_zero() {
        let factors: Vec<f64> = (0..1000).map(|step| LearningRateSchedule::Cosine.factor(step, 1000)).collect();
        let top = factors.iter().copied().fold(0.0, f64::max);
        assert!((top - 1.0).abs() < 1e-2 && factors[0] < 0.02 && factors[999] < 1e-4);
        let peak = factors.iter().position(|&factor| factor >= top).unwrap();
        assert!((45..55).contains(&peak));
        assert!(factors[..=peak].is_sorted());
        assert!(factors[peak..].iter().rev().is_sorted());
    }
}
