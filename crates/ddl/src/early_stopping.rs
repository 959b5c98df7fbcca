//! The validation windows of a training under way: how good each epoch is, and when none better is to be expected.

use crate::test_set::TestSet;
use crate::walk::Gait;
use crate::{DdlError, GoalModel, network_forecast};
use ddl_data::{Fold, Window};
use ddl_eval::{Scene, metric::displacement::DisplacementErrors};
use ddl_goal::GoalSet;
use ddl_star::{EpochReport, StarNetwork};

/// Validation walkers that each epoch is measured on, at least, where there are so many.
const WALKERS: usize = 1000;

/// Windows that were kept for validation, with their goals, and for how many epochs a better one is waited for.
#[derive(Debug)]
pub(crate) struct EarlyStopping {
    patience: usize,
    windows: Vec<Window>,
    goals: Vec<Vec<GoalSet>>,
    seed: u64,
}

impl EarlyStopping {
    /// With the validation windows of the fold, or a seeded part of them; `None` where the run trains all epochs.
    ///
    /// # Errors
    /// When the goals of the windows cannot be estimated.
    pub(crate) fn of(goals: &GoalModel, fold: &Fold<'_>) -> Result<Option<Self>, DdlError> {
        let config = goals.config();
        let (data, Some(patience)) = (&config.data, config.patience) else {
            return Ok(None);
        };
        let kept = (data.window_rule, data.validation);
        let windows = TestSet::validation(fold, data.convention, kept, Some(WALKERS)).windows;
        Ok(Some(Self {
            patience,
            goals: goals.goals(&windows)?,
            windows,
            seed: config.training.seed,
        }))
    }

    /// minADE over the walkers, metres: the best hypothesis of each, as under the protocol `fair`.
    pub(crate) fn min_ade(&self, network: &StarNetwork) -> Result<f64, DdlError> {
        let (windows, goals) = (&self.windows, self.goals.clone());
        let forecasts =
            network_forecast::towards(network, self.seed, windows, goals, Gait::Stable(None))?;
        let (mut sum, mut walkers) = (0.0, 0);
        for (window, forecast) in windows.iter().zip(&forecasts) {
            let errors = DisplacementErrors::of(&Scene::new(window, forecast)?);
            sum += (0..window.len()).map(|i| errors.min_ade(i)).sum::<f64>();
            walkers += window.len();
        }
        Ok(sum / walkers as f64)
    }

    /// Whether no better epoch is to be expected.
    pub(crate) fn is_over(&self, epochs: &[EpochReport]) -> bool {
        is_over(epochs, self.patience)
    }
}

/// The epoch with the least validation error, the first of them; `None` where none was measured.
#[must_use]
pub fn best_epoch(epochs: &[EpochReport]) -> Option<&EpochReport> {
    let measured = epochs.iter().filter(|epoch| epoch.validation.is_some());
    // `min_by` takes the first of equals
    measured.min_by(|a, b| {
        let error = |epoch: &EpochReport| epoch.validation.unwrap_or(f64::INFINITY);
        error(a).total_cmp(&error(b))
    })
}

/// Whether so many epochs have passed since the best one.
fn is_over(epochs: &[EpochReport], patience: usize) -> bool {
    match (best_epoch(epochs), epochs.last()) {
        (Some(best), Some(last)) => last.epoch.saturating_sub(best.epoch) >= patience,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn epochs(errors: &[f64]) -> Vec<EpochReport> {
        (1..)
            .zip(errors)
            .map(|(epoch, &error)| EpochReport {
                epoch,
                loss: 1.0,
                batches: 1,
                seconds: 1.0,
                validation: Some(error),
            })
            .collect()
    }

    #[test]
    fn training_is_over_when_the_best_epoch_is_long_past() {
        let errors = [0.5, 0.3, 0.4, 0.3, 0.35];
        let epochs = epochs(&errors);
        assert_eq!(best_epoch(&epochs).map(|epoch| epoch.epoch), Some(2));
        assert!(is_over(&epochs, 3));
        assert!(!is_over(&epochs, 4));
        assert!(!is_over(&epochs[..2], 1));
    }

    #[test]
    fn without_measurements_it_goes_on() {
        let mut epochs = epochs(&[0.5, 0.4]);
        for epoch in &mut epochs {
            epoch.validation = None;
        }
        assert_eq!(best_epoch(&epochs), None);
        assert!(!is_over(&epochs, 1));
        assert!(!is_over(&[], 1));
    }
}
