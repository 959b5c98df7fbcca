//! One window of a recording with its forecast (a snapshot), as data for galleries and the player.

use ddl_core::{
    Forecast, HORIZON, OBSERVED, ObservationQuality, PedestrianName, Position, Window, average_displacement, medoid,
};
use ddl_eval::metric::stability::RolloutStability;
use ddl_eval::{EvaluationError, ScoredWindow};
use serde::{Deserialize, Serialize};

/// Steps in a metre, or in a weight of 1, to which numbers are rounded.
const STEPS: f64 = 1e3;
/// Probability of the region whose radii a snapshot holds.
const REGION: f64 = 0.9;

/// Observation, forecast and true future at one moment of a recording.
///
/// Positions are in metres, rounded to the millimetre; weights are rounded to a thousandth. `falls` and `certified`
/// belong to the unrounded forecast.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ForecastSnapshot {
    /// The fold whose test scene holds it.
    pub fold: String,
    /// Name of the forecaster.
    pub forecaster: String,
    /// The recording.
    pub recording: String,
    /// Raw number of the last observed frame.
    pub frame: i64,
    /// The moment in words, such as `2.3 s`, where it is not this frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub when: Option<String>,
    /// Raw frames in a step of 0.4 s.
    pub frame_step: i64,
    /// The pedestrians of the window.
    pub pedestrians: Vec<SnapshotPedestrian>,
    /// Whether hypothesis k of all pedestrians is future k of the scene, with one weight for all of them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub joint: bool,
    /// Who walks together: indices of pedestrians, in the order of the moment; empty if unknown.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<Vec<usize>>,
}

/// One pedestrian of a [`ForecastSnapshot`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct SnapshotPedestrian {
    /// Number or name of the pedestrian in the recording.
    pub pedestrian: PedestrianName,
    /// 8 observed positions, m.
    pub observed: Vec<Position>,
    /// True future: 12 positions, m, or only the first of them if the pedestrian was not observed longer.
    pub truth: Vec<Position>,
    /// How well it was observed; `None` if nothing was estimated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quality: Option<ObservationQuality>,
    /// Similarity of the observed motion to the training data, 0 to 1; `None` if the forecaster does not give it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub familiarity: Option<f64>,
    /// K hypotheses.
    pub hypotheses: Vec<SnapshotHypothesis>,
}

/// One hypothesis of a [`SnapshotPedestrian`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct SnapshotHypothesis {
    /// Its weight, in [0, 1].
    pub weight: f64,
    /// 12 positions, m.
    pub positions: Vec<Position>,
    /// Radii of its discs in the 90 % region, one for each step, m: 0 where it has no disc, empty for forecasts without
    /// regions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub radii: Vec<f64>,
    /// Its goal, m; `None` for forecasts without goals.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub goal: Option<Position>,
    /// Whether the distance to the goal, Phi, falls at every step; `None` without a goal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decreasing: Option<bool>,
    /// Whether the forecaster's certificate holds; `None` without a certificate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certified: Option<bool>,
}

impl SnapshotPedestrian {
    /// Index of the hypothesis shown as the forecast: [`Forecast::representative`] of the rounded paths and weights.
    pub(crate) fn representative(&self) -> usize {
        let weights: Vec<f64> = self.hypotheses.iter().map(|h| h.weight).collect();
        let path = |k: usize| &self.hypotheses[k].positions;
        medoid(&weights, |k, j| average_displacement(path(k), path(j)))
    }
}

impl ForecastSnapshot {
    /// The snapshot of a window and its forecast.
    ///
    /// # Errors
    /// The forecast is not of the window's pedestrians, or the window has no future.
    pub fn new(
        fold: impl Into<String>,
        forecaster: impl Into<String>,
        window: &Window,
        forecast: &Forecast,
    ) -> Result<Self, EvaluationError> {
        let scene = ScoredWindow::new(window, forecast)?;
        let truths: Vec<&[Position]> = (0..window.len()).map(|i| scene.truth(i)).collect();
        Ok(Self::of((fold.into(), forecaster.into()), window, forecast, &truths))
    }

    /// The snapshot of a window without a future, such as the last one of a recording.
    ///
    /// `seen[i]`: the true positions of pedestrian `i` as far as they were observed, m; 0 to 12 of them.
    ///
    /// # Errors
    /// The forecast or `seen` is not of the window's pedestrians, or `seen` has more than 12 positions of a pedestrian.
    pub fn under_way(
        forecaster: impl Into<String>,
        window: &Window,
        forecast: &Forecast,
        seen: &[Vec<Position>],
    ) -> Result<Self, EvaluationError> {
        for found in [forecast.pedestrians(), seen.len()] {
            EvaluationError::unless_same_pedestrians(window, found)?;
        }
        let seen: Vec<&[Position]> = seen.iter().map(Vec::as_slice).collect();
        let longest = seen.iter().map(|path| path.len()).max().unwrap_or_default();
        if longest > HORIZON {
            return Err(EvaluationError::Seen { longest });
        }
        Ok(Self::of((window.recording().to_owned(), forecaster.into()), window, forecast, &seen))
    }

    fn of((fold, forecaster): (String, String), window: &Window, forecast: &Forecast, truths: &[&[Position]]) -> Self {
        let pedestrians = truths.iter().enumerate().map(|(i, truth)| pedestrian(window, forecast, truth, i));
        Self {
            fold,
            forecaster,
            recording: window.recording().to_owned(),
            frame: window.frames()[OBSERVED - 1],
            when: None,
            frame_step: window.frame_step(),
            pedestrians: pedestrians.collect(),
            joint: false,
            groups: Vec::new(),
        }
    }
}

fn pedestrian(window: &Window, forecast: &Forecast, truth: &[Position], i: usize) -> SnapshotPedestrian {
    let last = window.observed(i)[OBSERVED - 1];
    let hypothesis = |k: usize| {
        let goal = forecast.goal(i, k);
        let path = forecast.hypothesis(i, k);
        debug_assert_eq!(path.len(), HORIZON);
        SnapshotHypothesis {
            weight: round(forecast.weight(i, k)),
            positions: positions(path),
            radii: match forecast.regions() {
                None => Vec::new(),
                Some(_) => {
                    (0..HORIZON).map(|t| round(forecast.region_radius(i, k, t, REGION).unwrap_or(0.0))).collect()
                }
            },
            goal: goal.map(|goal| goal.map(round)),
            decreasing: goal.map(|goal| RolloutStability::of(last, path, goal).decreasing),
            certified: forecast.certified(i, k),
        }
    };
    let quality = window.quality(i);
    SnapshotPedestrian {
        pedestrian: window.name(i),
        observed: positions(window.observed(i)),
        truth: positions(truth),
        quality: (quality != ObservationQuality::default()).then_some(quality),
        familiarity: forecast.familiarity(i).map(round),
        hypotheses: (0..forecast.hypotheses()).map(hypothesis).collect(),
    }
}

fn positions(path: &[Position]) -> Vec<Position> {
    path.iter().map(|p| p.map(round)).collect()
}

fn round(value: f64) -> f64 {
    (value * STEPS).round() / STEPS
}
