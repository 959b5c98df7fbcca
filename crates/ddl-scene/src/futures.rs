//! The joint futures of a scene: the position of each pedestrian in each of them, at any time.

use crate::error::SceneError;
use crate::groups::Company;
use crate::mixture::JointScene;
use crate::parts::{ScenePart, SceneParts};
use crate::plan::Plan;
use ddl_core::{Forecast, HORIZON, OBSERVED, Position, TIME_STEP, Window, between};
use serde::{Deserialize, Serialize};

/// Two pedestrians have the same weight of a future if the weights differ by at most this much.
const EQUAL_WEIGHTS: f64 = 1e-9;

/// A scene of N pedestrians as a product of independent [parts](ScenePart), and K weighted futures drawn from it: in
/// future k every pedestrian follows its hypothesis k of [`forecast`](Self::forecast).
///
/// Risk and occupancy are computed from the hypotheses of each pedestrian by their share of the samples, not from the
/// K futures. Around its path a pedestrian is distributed as the [spread](ddl_core::Spread) of the forecast states.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Futures {
    present: Vec<Position>,
    /// `[N]`: the scale at the moment itself, metres.
    deviations: Vec<f64>,
    /// `[N]`: whether the motion is known, by which somebody may be seen to keep away.
    are_known: Vec<bool>,
    company: Company,
    parts: Vec<ScenePart>,
    /// What each pedestrian may do; `None` where these are the futures themselves.
    hypotheses: Option<Forecast>,
    /// `[N][K]`: where the hypotheses begin (m); empty if all begin at the present positions.
    starts: Vec<Position>,
    forecast: Forecast,
    plan: Option<Plan>,
}

impl Futures {
    /// The futures of a joint forecast of this window, which are all that is known of the scene. Its pedestrians
    /// respond to a plan if there is one.
    ///
    /// # Errors
    /// The forecast has another number of pedestrians, or more than 255 hypotheses; the weight of a hypothesis differs
    /// between pedestrians.
    pub fn new(window: &Window, forecast: Forecast, plan: Option<Plan>) -> Result<Self, SceneError> {
        if forecast.hypotheses() > JointScene::MOST_HYPOTHESES {
            let (found, most) = (forecast.hypotheses(), JointScene::MOST_HYPOTHESES);
            return Err(SceneError::Hypotheses { found, most });
        }
        let weights = (0..forecast.hypotheses()).map(|k| forecast.weight(0, k)).collect();
        let pedestrians = (0..forecast.pedestrians()).collect();
        let parts = vec![ScenePart::together(pedestrians, weights)];
        let parts = SceneParts { parts, company: Company::of(window) };
        Self::drawn(window, parts, (None, Vec::new()), forecast, plan)
    }

    /// The scene of these parts, whose pedestrians have these hypotheses, and futures drawn from it. `starts` `[N][K]`
    /// (m) is where the hypotheses begin, where some explain the last row otherwise, else empty.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    ///
    /// # Panics
    /// When there is another number of starts than of hypotheses.
    pub fn of_parts(
        window: &Window,
        parts: SceneParts,
        hypotheses: Forecast,
        starts: Vec<Position>,
        forecast: Forecast,
        plan: Option<Plan>,
    ) -> Result<Self, SceneError> {
        assert!(starts.is_empty() || starts.len() == window.len() * hypotheses.hypotheses(), "{} starts", starts.len());
        Self::drawn(window, parts, (Some(hypotheses), starts), forecast, plan)
    }

    fn drawn(
        window: &Window,
        SceneParts { parts, company }: SceneParts,
        (hypotheses, starts): (Option<Forecast>, Vec<Position>),
        forecast: Forecast,
        plan: Option<Plan>,
    ) -> Result<Self, SceneError> {
        if window.len() != forecast.pedestrians() {
            return Err(SceneError::Pedestrians { window: window.len(), forecast: forecast.pedestrians() });
        }
        for pedestrian in 1..forecast.pedestrians() {
            for future in 0..forecast.hypotheses() {
                let [expected, found] = [0, pedestrian].map(|i| forecast.weight(i, future));
                if (expected - found).abs() > EQUAL_WEIGHTS {
                    return Err(SceneError::NotJoint { future, pedestrian, expected, found });
                }
            }
        }
        let present = (0..window.len()).map(|i| window.observed(i)[OBSERVED - 1]).collect();
        let of_other = |i: usize| window.other(i).map_or(0.0, |other| other.quality.deviation);
        let deviations = (0..window.len()).map(|i| window.own_quality(i).deviation.max(of_other(i))).collect();
        let are_known = (0..window.len()).map(|i| !window.quality(i).is_hardly_observed()).collect();
        Ok(Self { present, deviations, are_known, company, parts, hypotheses, starts, forecast, plan })
    }

    /// [Groups](crate::groups) of pedestrians who walk together, as indices.
    pub fn groups(&self) -> &[Vec<usize>] {
        &self.company.groups
    }

    /// What the observation tells of people who are near each other.
    pub(crate) fn company(&self) -> &Company {
        &self.company
    }

    /// The forecast: hypothesis k of every pedestrian is future k.
    pub fn forecast(&self) -> &Forecast {
        &self.forecast
    }

    /// The independent parts of the scene: their samples choose among the [hypotheses](Self::hypotheses).
    pub fn parts(&self) -> &[ScenePart] {
        &self.parts
    }

    /// What each pedestrian may do.
    pub fn hypotheses(&self) -> &Forecast {
        self.hypotheses.as_ref().unwrap_or(&self.forecast)
    }

    /// The futures of the given pedestrians, at least one, in the given order. The others have shaped them, but count
    /// in no answer.
    ///
    /// # Panics
    /// When an index is out of range, or given twice.
    #[must_use]
    pub fn of_pedestrians(&self, pedestrians: &[usize]) -> Self {
        let mut places = vec![None; self.pedestrians()];
        for (place, &i) in pedestrians.iter().enumerate() {
            assert!(places[i].replace(place).is_none(), "pedestrian {i} is given twice");
        }
        let place = |i: &usize| places[*i];
        Self {
            present: pedestrians.iter().map(|&i| self.present[i]).collect(),
            deviations: pedestrians.iter().map(|&i| self.deviations[i]).collect(),
            are_known: pedestrians.iter().map(|&i| self.are_known[i]).collect(),
            company: self.company.of_pedestrians(pedestrians, place),
            parts: self.parts.iter().filter_map(|part| part.renumbered(|i| place(&i))).collect(),
            starts: if self.starts.is_empty() {
                Vec::new()
            } else {
                let count = self.hypotheses().hypotheses();
                pedestrians.iter().flat_map(|&i| (0..count).map(move |k| self.start(i, k))).collect()
            },
            hypotheses: self.hypotheses.as_ref().map(|hypotheses| hypotheses.of_pedestrians(pedestrians)),
            forecast: self.forecast.of_pedestrians(pedestrians),
            plan: self.plan.clone(),
        }
    }

    /// Whether the motion of pedestrian `i` is known. Of others nobody knows whether they keep away from anything.
    pub(crate) fn is_known(&self, i: usize) -> bool {
        self.are_known[i]
    }

    /// The plan that the pedestrians respond to; `None` if they were given none.
    pub fn plan(&self) -> Option<&Plan> {
        self.plan.as_ref()
    }

    /// The forecast without what else is known of the scene.
    pub fn into_forecast(self) -> Forecast {
        self.forecast
    }

    /// Number of pedestrians, N.
    pub fn pedestrians(&self) -> usize {
        self.present.len()
    }

    /// The last observed position of pedestrian `i`, metres.
    pub fn present(&self, i: usize) -> Position {
        self.present[i]
    }

    /// Where hypothesis `k` of pedestrian `i` begins, metres: at its present position, unless that is doubtful.
    pub(crate) fn start(&self, i: usize, k: usize) -> Position {
        let start = self.starts.get(i * self.hypotheses().hypotheses() + k);
        start.copied().unwrap_or(self.present[i])
    }

    /// The position of pedestrian `i` on its hypothesis `k`, `time` seconds after the moment, metres: on straight lines
    /// between the steps. Before the moment it is where that begins, after 4.8 s the last one.
    pub fn position(&self, i: usize, k: usize, time: f64) -> Position {
        let path = self.hypotheses().hypothesis(i, k);
        let (step, share) = step_of(time);
        let from = if step == 0 { self.start(i, k) } else { path[step - 1] };
        between(from, path[step.min(HORIZON - 1)], share)
    }

    /// The scale (m) of the Student's t around that position; at the moment itself the deviation of the last observed
    /// position, 0 for one that is a row. `None` without a spread.
    pub fn scale(&self, i: usize, time: f64) -> Option<f64> {
        let (step, share) = step_of(time);
        let [from, to] = [step, (step + 1).min(HORIZON)].map(|step| self.scale_at(i, step));
        let (from, to) = from.zip(to)?;
        Some(from + share * (to - from))
    }

    /// The [scale](Self::scale) at a step, 0 to 12.
    pub(crate) fn scale_at(&self, i: usize, step: usize) -> Option<f64> {
        match step {
            0 => Some(self.deviations[i]),
            _ => self.hypotheses().scale(i, step - 1),
        }
    }
}

/// The step that a time (s) lies after, 0 to 12, and the share of the way to the next one.
fn step_of(time: f64) -> (usize, f64) {
    let steps = (time / TIME_STEP).clamp(0.0, HORIZON as f64);
    (steps as usize, steps.fract())
}

#[cfg(test)]
mod tests;
