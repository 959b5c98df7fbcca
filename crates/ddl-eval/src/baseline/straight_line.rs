//! Straight lines to the goals: the quality of a goal estimator without a model.

use ddl_core::{Forecast, ForecastError, Forecaster, HORIZON, OBSERVED, Position, WeightedGoals, Window};

/// An estimator of the goals of the pedestrians of a window.
pub trait GoalSource {
    /// The name printed in tables, as in "straight line to NAME".
    fn name(&self) -> String;

    /// The goals of every pedestrian, in the order of the window; all sets have the same size.
    ///
    /// # Errors
    /// The goals cannot be estimated, or they need a future and the window has none.
    fn goals(&self, window: &Window) -> Result<Vec<WeightedGoals>, ForecastError>;
}

/// Known goals of the pedestrians of one window.
impl GoalSource for Vec<WeightedGoals> {
    fn name(&self) -> String {
        "the given goals".to_owned()
    }

    fn goals(&self, _window: &Window) -> Result<Self, ForecastError> {
        Ok(self.clone())
    }
}

/// The last true position: an oracle, for the protocol `published` only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TrueEndpoint;

impl GoalSource for TrueEndpoint {
    fn name(&self) -> String {
        "the TRUE end".to_owned()
    }

    fn goals(&self, window: &Window) -> Result<Vec<WeightedGoals>, ForecastError> {
        let end = |i| window.end(i).map(WeightedGoals::certain);
        (0..window.len()).map(end).collect::<Option<_>>().ok_or_else(|| ForecastError::FutureMissing {
            forecaster: self.name(),
            recording: window.recording().to_owned(),
            start_frame: window.start_frame(),
        })
    }
}

/// Straight at constant speed to each goal, with arrival at the 12th frame:
/// `p(8 + t) = p(8) + t/12 (g - p(8))`, one hypothesis for each goal, with the goal's weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StraightLine<G>(
    /// The source of the goals.
    pub G,
);

impl<G: GoalSource> Forecaster for StraightLine<G> {
    fn name(&self) -> String {
        format!("straight line to {}", self.0.name())
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        let sets = self.0.goals(window)?;
        let refuse = |problem| Err(ForecastError::Goals { goal_source: self.0.name(), problem });
        if sets.len() != window.len() {
            return refuse(format!("{} goal sets for {} pedestrians", sets.len(), window.len()));
        }
        let hypotheses = sets.first().map_or(0, |set| set.goals().len());
        if let Some(odd) = sets.iter().find(|set| set.goals().len() != hypotheses) {
            let found = odd.goals().len();
            return refuse(format!("sets of {hypotheses} and of {found} goals in one window"));
        }
        let mut positions = Vec::with_capacity(window.len() * hypotheses * HORIZON);
        for (i, set) in sets.iter().enumerate() {
            let start = window.observed(i)[OBSERVED - 1];
            for goal in set.goals() {
                positions.extend((1..=HORIZON).map(|t| between(start, *goal, t)));
            }
        }
        let weights = sets.iter().flat_map(|set| set.weights().iter().copied()).collect();
        let goals = sets.iter().flat_map(|set| set.goals().iter().copied()).collect();
        Ok(Forecast::new(window.len(), hypotheses, positions, weights, Some(goals))?)
    }
}

/// The position after `t` of 12 equal steps; the last one is the goal, bit by bit.
fn between(start: Position, goal: Position, t: usize) -> Position {
    if t == HORIZON {
        return goal;
    }
    let share = t as f64 / HORIZON as f64;
    [start[0] + share * (goal[0] - start[0]), start[1] + share * (goal[1] - start[1])]
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "sums and products of small integers are exact")]
mod tests {
    use super::*;
    use crate::fixture::window;
    use crate::protocol::Protocol;

    #[test]
    fn one_line_a_goal_with_its_weight() {
        let windows = [window(&[[0.0, 0.0]], &[[1.0, 0.0]])];
        let corners = WeightedGoals::new(vec![[12.0, 0.0], [0.0, -24.0]], vec![0.25, 0.75]);
        let straight = StraightLine(vec![corners.unwrap()]);
        let forecast = straight.forecast(&windows[0]).unwrap();
        assert_eq!(forecast.hypothesis(0, 0)[2], [3.0, 0.0]);
        assert_eq!(forecast.hypothesis(0, 1)[11], [0.0, -24.0]);
        assert_eq!(forecast.goal(0, 1), Some([0.0, -24.0]));
        assert_eq!(forecast.most_likely(0), 1);
        let single = Protocol::Single.forecast(&straight, &windows).unwrap();
        assert_eq!(single, [forecast.single()]);
        let error = StraightLine(Vec::new()).forecast(&windows[0]).unwrap_err();
        let expected = "goal source `the given goals`: 0 goal sets for 1 pedestrians";
        assert_eq!(error.to_string(), expected);
    }

    #[test]
    fn the_oracle_works_only_where_the_future_is_shown() {
        let windows = [window(&[[0.0, 0.0]], &[[1.0, 0.0]])];
        let oracle = StraightLine(TrueEndpoint);
        assert!(Protocol::Published.forecast(&oracle, &windows).is_ok());
        for protocol in [Protocol::Fair, Protocol::Single] {
            let error = protocol.forecast(&oracle, &windows).unwrap_err();
            assert!(matches!(error, ForecastError::FutureMissing { .. }));
        }
    }
}
