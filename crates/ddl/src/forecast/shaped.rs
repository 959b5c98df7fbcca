//! Forecasts of a network, trained or in training, for windows and their goals.

use crate::forecast::certified::Walked;
use crate::forecast::name::NAME;
use crate::trust::calibration::Calibration;
use ddl_core::{Forecast, ForecastError, Position, Window};
use ddl_goal::GoalSet;
use ddl_network::{ForecastWindows, Noise, StepRule, WindowRollout};

/// Hypotheses of the variant without goals: one for each noise vector.
const NOISE_HYPOTHESES: usize = 20;

/// The goals `[window][pedestrian]`, and the familiarity of the observed motion of each pedestrian.
#[derive(Debug, Clone)]
pub(crate) struct GuidedGoals {
    pub(crate) sets: Vec<Vec<GoalSet>>,
    pub(crate) familiarity: Vec<Vec<f64>>,
}

/// For every pedestrian, one hypothesis for each goal, with the weight of the goal. The more familiar the observed
/// motion, the more the network shapes the path. The variant without goals makes one for each noise vector of this
/// seed, all equally likely.
pub(crate) fn towards(
    network: &dyn ForecastWindows,
    seed: u64,
    windows: &[Window],
    goals: GuidedGoals,
    rule: StepRule,
) -> Result<Vec<Forecast>, ForecastError> {
    if !network.config().variant.uses_goal() {
        return without_goals(network, seed, windows);
    }
    walked(network, windows, goals, rule)?.map(Walked::forecast).collect()
}

/// The network's rollouts to all goals. Each becomes a forecast on demand, so that the certificates of many windows are
/// not kept.
pub(crate) fn walked<'a>(
    network: &'a dyn ForecastWindows,
    windows: &'a [Window],
    goals: GuidedGoals,
    rule: StepRule,
) -> Result<impl Iterator<Item = Walked<'a>>, ForecastError> {
    let GuidedGoals { sets, familiarity } = goals;
    let goals: Vec<Vec<Vec<Position>>> =
        sets.iter().map(|sets| sets.iter().map(|set| set.goals().to_vec()).collect()).collect();
    let share = |&familiarity: &f64| Calibration::fitted().share(familiarity);
    let shares: Vec<Vec<f64>> = familiarity.iter().map(|window| window.iter().map(share).collect()).collect();
    let rollouts = network
        .forecast_windows(windows, &goals, Noise::Expected, rule, Some(&shares))
        .map_err(|error| ForecastError::model(NAME, error))?;
    let shaped = rollouts.into_iter().zip(windows).zip(sets);
    let trusted = shares.into_iter().zip(familiarity);
    Ok(shaped.zip(trusted).map(move |(((rollout, window), sets), (shares, familiarity))| Walked {
        shares,
        familiarity: Some(familiarity),
        spread: None,
        origins: Vec::new(),
        config: network.config(),
        rule,
        window,
        hypotheses: rollout.hypotheses,
        rolled_out: rollout.positions,
        factors: rollout.factors,
        weights: sets.iter().flat_map(GoalSet::weights).copied().collect(),
        goals: sets.iter().flat_map(GoalSet::goals).copied().collect(),
    }))
}

/// Plain STAR: equally likely noise samples.
pub(crate) fn without_goals(
    network: &dyn ForecastWindows,
    seed: u64,
    windows: &[Window],
) -> Result<Vec<Forecast>, ForecastError> {
    let noise = Noise::Draws { count: NOISE_HYPOTHESES, seed };
    // This variant does not read the goals.
    let goals: Vec<_> = windows.iter().map(|window: &Window| vec![vec![[0.0; 2]]; window.len()]).collect();
    network
        .forecast_windows(windows, &goals, noise, StepRule::Bounded, None)
        .map_err(|error| ForecastError::model(NAME, error))?
        .into_iter()
        .map(with_equal_weights)
        .collect()
}

pub(crate) fn with_equal_weights(rollout: WindowRollout) -> Result<Forecast, ForecastError> {
    Ok(Forecast::with_equal_weights(rollout.pedestrians, rollout.hypotheses, rollout.positions)?)
}
