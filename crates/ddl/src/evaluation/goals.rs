//! Quality of the goals of a model on a set of windows.

use crate::error::DdlError;
use crate::goals::model::GoalModel;
use crate::goals::remembering::Remembering;
use crate::windows::test_set::{Split, TestSet};
use ddl_core::{Position, Window};
use ddl_data::Dataset;
use ddl_eval::metric::reliability::Reliability;
use ddl_goal::GoalSet;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::time::Instant;

/// Quality of the goals on a set of windows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GoalEvaluation {
    /// The fold.
    pub fold: String,
    /// Text that names the origin of the goals.
    pub goals: String,
    /// Text that names the windows.
    pub windows: String,
    /// Number of goals per pedestrian.
    pub clusters: usize,
    /// Errors over all pedestrians.
    pub all: GoalErrors,
    /// Errors of each recording.
    pub recordings: BTreeMap<String, GoalErrors>,
    /// Reliability of the probabilities of the goals.
    pub calibration: Option<Reliability>,
    /// Wall-clock seconds that the estimation took.
    pub seconds: f64,
}

/// Distances between goals and true endpoints in metres, means over pedestrians.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct GoalErrors {
    /// Number of pedestrians.
    pub pedestrians: usize,
    /// Mean distance of the goal nearest the TRUE endpoint (m): a lower bound for every forecast that ends at a goal.
    pub oracle_fde: f64,
    /// Mean distance of the most likely goal (m).
    pub likeliest_fde: f64,
}

impl GoalErrors {
    fn of<'a>(sets: impl Iterator<Item = (&'a GoalSet, Position)>) -> Self {
        let mut sum = Self::default();
        for (set, end) in sets {
            let off = |goal: usize| {
                let [x, y] = set.goals()[goal];
                (x - end[0]).hypot(y - end[1])
            };
            sum.pedestrians += 1;
            sum.oracle_fde += off(set.nearest(end));
            sum.likeliest_fde += off(0);
        }
        let pedestrians = sum.pedestrians.max(1) as f64;
        Self {
            pedestrians: sum.pedestrians,
            oracle_fde: sum.oracle_fde / pedestrians,
            likeliest_fde: sum.likeliest_fde / pedestrians,
        }
    }
}

/// Measures the goals of a run on its validation windows, or on the test windows of its fold (headline rule, all
/// pedestrians).
///
/// The goals are estimated from the 8 observed frames and the memory of the place.
///
/// # Errors
/// When the data is not the training data of the run, or goals cannot be estimated.
pub fn evaluate_goals(
    model: &GoalModel,
    dataset: &Dataset,
    on: Split,
    memory: Option<Remembering>,
) -> Result<GoalEvaluation, DdlError> {
    let test = TestSet::of_run(model, dataset, on, &[], None)?;
    let rule = test.rules.first().map(|(rule, _)| *rule);
    let mut windows: Vec<Window> = test.headline().cloned().collect();
    if let Some(memory) = memory {
        windows = model.remembering(&windows, dataset, memory)?;
    }
    let observed: Vec<Window> = windows.iter().map(Window::without_future).collect();
    let started = Instant::now();
    let sets = model.goals(&observed)?;
    let seconds = started.elapsed().as_secs_f64();
    // Bystanders have goals and no future.
    let with_future = |(window, sets): (&Window, Vec<GoalSet>)| {
        window.indices_in_scene().into_iter().map(|i| sets[i].clone()).collect()
    };
    let sets: Vec<Vec<GoalSet>> = windows.iter().zip(sets).map(with_future).collect();
    let pairs: Vec<(&Window, &GoalSet, Position)> = windows
        .iter()
        .zip(&sets)
        .flat_map(|(window, sets)| {
            let ends = (0..window.len()).map(|i| window.end(i));
            sets.iter().zip(ends).filter_map(move |(set, end)| Some((window, set, end?)))
        })
        .collect();
    let errors = |name: Option<&str>| {
        let is_counted = |window: &Window| name.is_none_or(|name| window.recording() == name);
        let counted = pairs.iter().filter(|(window, ..)| is_counted(window));
        GoalErrors::of(counted.map(|(_, set, end)| (*set, *end)))
    };
    let mut recordings = BTreeMap::new();
    for window in &windows {
        let name = window.recording();
        if !recordings.contains_key(name) {
            recordings.insert(name.to_owned(), errors(Some(name)));
        }
    }
    let likelihoods = pairs.iter().map(|(_, set, end)| (set.weights(), set.nearest(*end)));
    let rule = rule.map_or(String::new(), |rule| format!("{rule} rule"));
    let words = test.subset.map_or_else(|| format!("all test windows, {rule}"), |subset| format!("{subset}, {rule}"));
    Ok(GoalEvaluation {
        fold: test.fold,
        goals: model.words(),
        windows: words,
        clusters: model.clusters(),
        all: errors(None),
        calibration: Reliability::of(likelihoods),
        recordings,
        seconds,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ddl_goal::HeadingFrame;

    /// Goals at (3, 1) and (0, -3), the first more likely. The ends are 5 m and 3 m from it, and 0 m and 3 m from the
    /// nearest.
    #[test]
    fn errors_by_hand() {
        let frame = HeadingFrame::new(&[[-1.0, 0.0], [0.0, 0.0]]).unwrap();
        let set = GoalSet::from_endpoints(&frame, &[[0.0, -3.0], [3.0, 1.0]], &[0.4, 0.6], 2).unwrap();
        let errors = GoalErrors::of([(&set, [0.0, -3.0]), (&set, [3.0, 4.0])].into_iter());
        assert_eq!(errors.pedestrians, 2);
        assert!((errors.oracle_fde - 1.5).abs() < 1e-12 && (errors.likeliest_fde - 4.0).abs() < 1e-12, "{errors:?}");
        assert_eq!(GoalErrors::of([].into_iter()), GoalErrors::default());
    }
}
