//! A pedestrian with its estimated goals: one panel of a picture.

use ddl_core::{Forecast, WeightedGoals, distance};
use ddl_data::{OBSERVED, Position, WINDOW};

use crate::error::ReportError;

/// Positions farther from the pedestrian are an error (m).
const FARTHEST: f64 = 1e6;

/// The observed and the true future track of a pedestrian, and its estimated goals.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalCase {
    pub(super) title: String,
    track: Vec<Position>,
    pub(super) goals: WeightedGoals,
    experts: Vec<Vec<Position>>,
    /// Index of the goal nearest the true endpoint; among equally near goals the most probable one, then the first.
    pub(super) nearest: usize,
}

impl GoalCase {
    /// A pedestrian and its goals, with the tracks of the expert library that the goals come from, in any order.
    ///
    /// # Shapes
    /// `track` and each expert: 20 positions (m), 8 observed and 12 true future ones, in the coordinates of `goals`.
    /// The experts are transformed to this pedestrian; their last 12 positions are drawn.
    ///
    /// # Errors
    /// Not 20 positions; a position or goal that is not finite or more than 1000 km from the last observed position;
    /// weights outside [0, 1], or that do not sum to 1.
    pub fn new(
        title: impl Into<String>,
        track: &[Position],
        goals: WeightedGoals,
        experts: Vec<Vec<Position>>,
    ) -> Result<Self, ReportError> {
        let title = title.into();
        match check(track, &goals, &experts) {
            Ok(nearest) => Ok(Self {
                title,
                track: track.to_vec(),
                goals,
                experts,
                nearest,
            }),
            Err(problem) => Err(ReportError::GoalCase { case: title, problem }),
        }
    }

    /// Distance of the nearest goal from the true endpoint, metres.
    pub(super) fn error(&self) -> f64 {
        distance(self.goals.goals()[self.nearest], self.track[WINDOW - 1])
    }

    pub(super) fn here(&self) -> Position {
        self.track[OBSERVED - 1]
    }

    pub(super) fn observed(&self) -> &[Position] {
        &self.track[..OBSERVED]
    }

    pub(super) fn truth(&self) -> &[Position] {
        &self.track[OBSERVED..]
    }

    pub(super) fn expert_paths(&self) -> impl Iterator<Item = &[Position]> {
        self.experts.iter().map(|expert| &expert[OBSERVED - 1..])
    }
}

/// The index of the nearest goal, or what is wrong.
fn check(track: &[Position], goals: &WeightedGoals, experts: &[Vec<Position>]) -> Result<usize, String> {
    if track.len() != WINDOW {
        let count = track.len();
        return Err(format!(
            "the track must hold 20 positions (8 observed, 12 true), found {count}"
        ));
    }
    let (here, end) = (track[OBSERVED - 1], track[WINDOW - 1]);
    check_near(here, track, |step| format!("position {step} of the track"))?;
    check_near(here, goals.goals(), |goal| format!("goal {goal}"))?;
    for (index, expert) in experts.iter().enumerate() {
        if expert.len() != WINDOW {
            let count = expert.len();
            return Err(format!("expert {index} must hold 20 positions, found {count}"));
        }
        check_near(here, expert, |step| format!("position {step} of expert {index}"))?;
    }
    let weights = goals.weights();
    for (goal, &weight) in weights.iter().enumerate() {
        if !(0.0..=1.0 + Forecast::WEIGHT_TOLERANCE).contains(&weight) {
            return Err(format!(
                "goal {goal} has the weight {weight}, which is not between 0 and 1"
            ));
        }
    }
    let sum: f64 = weights.iter().sum();
    if (sum - 1.0).abs() > Forecast::WEIGHT_TOLERANCE {
        return Err(format!("the weights sum to {sum}, not to 1; divide them by their sum"));
    }
    let distances = goals.goals().iter().map(|goal| distance(*goal, end));
    let by_distance = |a: &(usize, (f64, &f64)), b: &(usize, (f64, &f64))| {
        let ((_, (a, v)), (_, (b, w))) = (a, b);
        a.total_cmp(b).then(w.total_cmp(v))
    };
    let nearest = distances.zip(weights).enumerate().min_by(by_distance);
    Ok(nearest.map_or(0, |(index, _)| index))
}

fn check_near(here: Position, positions: &[Position], name: impl Fn(usize) -> String) -> Result<(), String> {
    // NaN is not near.
    let near = |position: &Position| distance(*position, here) <= FARTHEST;
    match positions.iter().position(|position| !near(position)) {
        None => Ok(()),
        Some(index) => Err(format!(
            "{} is {:?}, which is not within 1000 km of the last observed position; give metres in the coordinates of \
             the track",
            name(index),
            positions[index]
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track() -> Vec<Position> {
        (0..WINDOW).map(|t| [0.5 * t as f64, 1.0]).collect()
    }

    fn goals(goals: &[Position], weights: &[f64]) -> WeightedGoals {
        WeightedGoals::new(goals.to_vec(), weights.to_vec()).unwrap()
    }

    fn message(result: Result<GoalCase, ReportError>) -> String {
        result.unwrap_err().to_string()
    }

    #[test]
    fn the_nearest_goal_by_hand() {
        for (places, weights, expected) in [
            ([[4.0, 1.0], [9.5, 1.5], [9.5, 3.0]], [0.6, 0.1, 0.3], (1, 0.5)),
            ([[9.5, 2.0], [9.5, 0.0], [9.5, 2.0]], [0.0, 0.4, 0.6], (2, 1.0)),
        ] {
            let case = GoalCase::new("a", &track(), goals(&places, &weights), Vec::new()).unwrap();
            assert_eq!(case.nearest, expected.0);
            assert!((case.error() - expected.1).abs() < 1e-12);
        }
    }

    #[test]
    fn what_is_no_case_says_where_and_why() {
        let refused = |track: &[Position], second: Position, weight: f64, said: &str| {
            let set = goals(&[[9.0, 1.0], second], &[weight, 0.5]);
            let message = message(GoalCase::new("hotel, pedestrian 3", track, set, Vec::new()));
            assert!(message.starts_with("case `hotel, pedestrian 3`: "));
            assert!(message.contains(said), "{message}");
        };
        let good = [8.0, 1.0];
        let short = "the track must hold 20 positions (8 observed, 12 true), found 19";
        refused(&track()[..19], good, 0.5, short);
        for (step, place, said) in [
            (7, [f64::NAN, 0.0], "position 0 of the track"),
            (13, [6.5, f64::INFINITY], "position 13 of the track is [6.5, inf]"),
        ] {
            let mut broken = track();
            broken[step] = place;
            refused(&broken, good, 0.5, said);
        }
        for far in [f64::NAN, 1e300, -2e6] {
            refused(&track(), [far, 1.0], 0.5, "goal 1 is");
        }
        for (weight, said) in [
            (f64::NAN, "goal 0 has the weight NaN"),
            (-0.5, "goal 0 has the weight -0.5"),
            (0.25, "the weights sum to 0.75, not to 1"),
        ] {
            refused(&track(), good, weight, said);
        }
        let with = |experts| message(GoalCase::new("a", &track(), goals(&[[9.0, 1.0]], &[1.0]), experts));
        let short = with(vec![track(), track()[1..].to_vec()]);
        assert!(short.contains("expert 1 must hold 20 positions, found 19"));
        let mut lost = track();
        lost[19][0] = f64::NEG_INFINITY;
        let lost = with(vec![track(), track(), lost]);
        assert!(lost.contains("position 19 of expert 2 is"), "{lost}");
    }
}
