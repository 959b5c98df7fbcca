//! One moment of a recording and what was forecast then, as data for galleries and the player.

use ddl_data::{HORIZON, OBSERVED, Position, Window};
use serde::{Deserialize, Serialize};

use crate::{
    Forecast, Scene,
    error::EvaluationError,
    gallery::Pick,
    metric::{displacement::average_displacement, stability::RolloutStability},
    representative::medoid,
};

/// Decimals of the positions and weights kept: a millimetre, a thousandth.
const KEPT: f64 = 1e3;

/// What was observed, what was forecast and what then happened, at one moment of a recording.
///
/// Positions are metres rounded to the millimetre, weights to a thousandth: for looking at. The verdicts are those of the
/// unrounded forecast.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Moment {
    /// The fold whose test scene it is from.
    pub fold: String,
    /// Who forecast.
    pub forecaster: String,
    /// The recording.
    pub recording: String,
    /// Raw number of the last observed frame.
    pub frame: i64,
    /// Raw frames a step of 0.4 s.
    pub frame_step: i64,
    /// Everybody in the window.
    pub walkers: Vec<MomentWalker>,
    /// What the moment was chosen to show; empty when it was chosen for its place in time alone.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub picks: Vec<Pick>,
}

/// One person of a [`Moment`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct MomentWalker {
    /// The person's number in the recording.
    pub pedestrian: i64,
    /// 8 observed positions, m.
    pub observed: Vec<Position>,
    /// 12 true positions, m.
    pub truth: Vec<Position>,
    /// K hypotheses.
    pub hypotheses: Vec<MomentHypothesis>,
}

/// One hypothesis of a [`MomentWalker`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct MomentHypothesis {
    /// Its weight, in [0, 1].
    pub weight: f64,
    /// 12 positions, m.
    pub positions: Vec<Position>,
    /// Where it heads, m; `None` for forecasts without goals.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<Position>,
    /// Whether the distance to the goal, Phi, falls at every step; `None` without a goal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decreasing: Option<bool>,
    /// Whether the forecaster's certificate holds; `None` where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certified: Option<bool>,
}

impl MomentWalker {
    /// The hypothesis shown as the forecast: [`Forecast::representative`], of the rounded paths and weights kept here.
    pub(crate) fn representative(&self) -> usize {
        let weights: Vec<f64> = self.hypotheses.iter().map(|h| h.weight).collect();
        let path = |k: usize| &self.hypotheses[k].positions;
        medoid(&weights, |k, j| average_displacement(path(k), path(j)))
    }
}

impl Moment {
    /// The moment of a window and its forecast.
    ///
    /// # Errors
    /// The forecast is not of the window's pedestrians, or the window has no future.
    ///
    /// # Examples
    /// ```
    /// use ddl_data::{PedestrianId, Window};
    /// use ddl_eval::{Forecaster, Moment, baseline::ConstantVelocity};
    /// let walk = (0..20).map(|t| [0.4 * f64::from(t), 0.0]).collect();
    /// let window = Window::new("corridor", 0, 10, vec![PedestrianId(7)], vec![walk])?;
    /// let forecast = ConstantVelocity::last_step().forecast(&window)?;
    /// let moment = Moment::new("corridor", "constant velocity", &window, &forecast)?;
    /// assert_eq!(moment.frame, 70);
    /// assert_eq!(moment.walkers[0].hypotheses[0].positions[11], [7.6, 0.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        fold: impl Into<String>,
        forecaster: impl Into<String>,
        window: &Window,
        forecast: &Forecast,
    ) -> Result<Self, EvaluationError> {
        let scene = Scene::new(window, forecast)?;
        let walkers = (0..window.len()).map(|i| walker(&scene, i)).collect();
        Ok(Self {
            fold: fold.into(),
            forecaster: forecaster.into(),
            recording: window.recording().to_owned(),
            frame: window.frames()[OBSERVED - 1],
            frame_step: window.frame_step(),
            walkers,
            picks: Vec::new(),
        })
    }

    /// The same moment, chosen to show something.
    #[must_use]
    pub fn picked(self, picks: Vec<Pick>) -> Self {
        Self { picks, ..self }
    }
}

fn walker(scene: &Scene<'_>, i: usize) -> MomentWalker {
    let forecast = scene.forecast();
    let hypothesis = |k: usize| {
        let goal = forecast.goal(i, k);
        let path = forecast.hypothesis(i, k);
        debug_assert_eq!(path.len(), HORIZON);
        MomentHypothesis {
            weight: round(forecast.weight(i, k)),
            positions: positions(path),
            goal: goal.map(|goal| goal.map(round)),
            decreasing: goal
                .map(|goal| RolloutStability::of(scene.last_observed(i), path, goal).decreasing),
            certified: forecast.certified(i, k),
        }
    };
    MomentWalker {
        pedestrian: scene.window().pedestrians()[i].0,
        observed: positions(scene.window().observed(i)),
        truth: positions(scene.truth(i)),
        hypotheses: (0..scene.hypotheses()).map(hypothesis).collect(),
    }
}

fn positions(path: &[Position]) -> Vec<Position> {
    path.iter().map(|p| p.map(round)).collect()
}

fn round(value: f64) -> f64 {
    (value * KEPT).round() / KEPT
}
