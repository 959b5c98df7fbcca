//! Forecasts of a network, trained or in training, for windows and their goals.

use crate::forecast::certified::Walked;
use crate::forecast::name::NAME;
use crate::goals::first_seen::KnownMotions;
use crate::trust::calibration::Calibration;
use ddl_core::{Forecast, ForecastError, HORIZON, OBSERVED, Position, Window, between};
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
    let known = KnownMotions::of(windows);
    let share = |&familiarity: &f64| Calibration::fitted().share(familiarity);
    let shares: Vec<Vec<f64>> = familiarity.iter().map(|window| window.iter().map(share).collect()).collect();
    let (known_goals, shares) = (known.only(&goals), known.only(&shares));
    let rollouts = network
        .forecast_windows(known.windows(), &known_goals, Noise::Expected, rule, Some(&shares))
        .map_err(|error| ForecastError::model(NAME, error))?;
    let rollouts = with_first_seen(&known, rollouts, windows, &goals, network.config().variant.dynamics());
    let shaped = rollouts.into_iter().zip(windows).zip(sets);
    let shares = known.with_others(shares.into_iter().flatten(), |_, _| 0.0);
    let trusted = shares.into_iter().zip(familiarity);
    Ok(shaped.zip(trusted).map(move |((((rolled_out, factors), window), sets), (shares, familiarity))| Walked {
        shares,
        familiarity: Some(familiarity),
        spread: None,
        origins: Vec::new(),
        config: network.config(),
        rule,
        window,
        hypotheses: sets[0].goals().len(),
        rolled_out,
        factors,
        weights: sets.iter().flat_map(GoalSet::weights).copied().collect(),
        goals: sets.iter().flat_map(GoalSet::goals).copied().collect(),
    }))
}

/// The path of every hypothesis of a window, `[N][K][12]`, and its factors.
type Shaped = (Vec<Position>, Option<Vec<[f64; 3]>>);

/// The rollouts of windows, with straight paths of the pedestrians seen for the first time: no network shapes them.
fn with_first_seen(
    known: &KnownMotions<'_>,
    rollouts: Vec<WindowRollout>,
    windows: &[Window],
    goals: &[Vec<Vec<Position>>],
    has_flow: bool,
) -> Vec<Shaped> {
    if known.are_all() {
        return rollouts.into_iter().map(|rollout| (rollout.positions, rollout.factors)).collect();
    }
    let of_each = rollouts.iter().flat_map(|rollout| {
        let size = rollout.hypotheses * HORIZON;
        let factors = rollout.factors.as_deref().unwrap_or_default();
        let of = move |i: usize| (&rollout.positions[i * size..][..size], factors.chunks(size).nth(i));
        (0..rollout.pedestrians).map(of).map(|(path, factors)| (path.to_vec(), factors.unwrap_or_default().to_vec()))
    });
    let straight = |window: usize, i: usize| {
        let (last, goals) = (windows[window].observed(i)[OBSERVED - 1], &goals[window][i]);
        let to = |&goal: &Position| (1..=HORIZON).map(move |t| between(last, goal, t as f64 / HORIZON as f64));
        (goals.iter().flat_map(to).collect(), vec![[1.0, 0.0, 1.0]; goals.len() * HORIZON])
    };
    let merged = known.with_others(of_each, straight).into_iter().map(|each| {
        let (paths, factors): (Vec<Vec<Position>>, Vec<Vec<[f64; 3]>>) = each.into_iter().unzip();
        (paths.concat(), has_flow.then(|| factors.concat()))
    });
    merged.collect()
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
