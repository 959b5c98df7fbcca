//! The validation windows of a training under way: how good each epoch is, and when none better is to be expected.

use crate::starting_model::StartingWeights;
use crate::test_set::TestSet;
use crate::walk::Gait;
use crate::{DdlError, GoalModel, RunConfig, RunDirectory, network_forecast};
use ddl_data::{Fold, Window};
use ddl_eval::{Scene, metric::displacement::DisplacementErrors};
use ddl_goal::GoalSet;
use ddl_star::{EpochReport, ProposalNetwork, StarNetwork};

/// Validation walkers that each epoch is measured on, at least, where there are so many.
const WALKERS: usize = 1000;

/// Windows that were kept for validation, with their goals, and for how many epochs a better one is waited for.
#[derive(Debug)]
pub(crate) struct EarlyStopping {
    patience: usize,
    windows: Vec<Window>,
    goals: Vec<Vec<GoalSet>>,
    familiarity: Vec<Vec<f64>>,
    seed: u64,
    starts_trained: bool,
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
            familiarity: windows
                .iter()
                .map(|window| goals.familiarity(window))
                .collect(),
            windows,
            seed: config.training.seed,
            starts_trained: config.from.is_some(),
        }))
    }

    /// minADE over the walkers, metres: the best hypothesis of each, as under the protocol `fair`.
    pub(crate) fn min_ade(&self, network: &StarNetwork) -> Result<f64, DdlError> {
        let (windows, led) = (
            &self.windows,
            (self.goals.clone(), self.familiarity.clone()),
        );
        let forecasts =
            network_forecast::towards(network, self.seed, windows, led, Gait::Stable(None))?;
        let (mut sum, mut walkers) = (0.0, 0);
        for (window, forecast) in windows.iter().zip(&forecasts) {
            let errors = DisplacementErrors::of(&Scene::new(window, forecast)?);
            sum += (0..window.len()).map(|i| errors.min_ade(i)).sum::<f64>();
            walkers += window.len();
        }
        Ok(sum / walkers as f64)
    }

    /// The first epoch that is measured: number 0 is the network before its first step, which counts where it is a trained one.
    pub(crate) fn first_epoch(&self) -> usize {
        usize::from(!self.starts_trained)
    }

    /// Whether no better epoch is to be expected.
    pub(crate) fn is_over(&self, epochs: &[EpochReport]) -> bool {
        is_over(epochs, self.patience)
    }
}

/// The better proposal network for a training that begins with the weights of another model: that model's own, or what has become of it. Better is whose
/// goals the forecasting network comes nearer the truth by, which has not been trained yet; without early stopping the trained one is taken.
///
/// # Errors
/// As [`EarlyStopping::of`] and [`EarlyStopping::min_ade`].
pub(crate) fn better_goals(
    start: StartingWeights,
    trained: ProposalNetwork,
    (run, config): (&RunDirectory, &RunConfig),
    fold: &Fold<'_>,
) -> Result<ProposalNetwork, DdlError> {
    let Some(untrained) = start.proposal else {
        return Ok(trained);
    };
    let measured = |proposal| -> Result<(f64, GoalModel), DdlError> {
        let goals = GoalModel::with_network(run.clone(), config.clone(), Some(proposal))?;
        let stopping = EarlyStopping::of(&goals, fold)?;
        let error = stopping.map_or(Ok(0.0), |stopping| stopping.min_ade(&start.network))?;
        Ok((error, goals))
    };
    let (before, after) = (measured(untrained)?, measured(trained)?);
    let (_, better) = if before.0 < after.0 { before } else { after };
    let network = better.into_proposal_network();
    network.ok_or_else(|| DdlError::run(run.path(), "has no proposal network"))
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
