//! From the hypotheses of single pedestrians to the joint futures of a scene.
//!
//! A future gives each pedestrian a goal, the mean of the goals of its mixture, and a flow there, whose factors of P
//! are the mean of those of the mixture. The mean of factors with positive diagonals has a positive diagonal, so P
//! stays positive definite, and every path has its certificate as a hypothesis has.

use crate::forecast::answer::Answer;
use crate::forecast::certified::Walked;
use crate::forecast::name::NAME;
use crate::trust::calibration::Calibration;
use ddl_core::{Forecast, ForecastError, HORIZON, OBSERVED, PedestrianName, Position, Spread, TIME_STEP, Window};
use ddl_scene::{Futures, JointMixture, JointScene, Plan, SceneError, SceneParts};

/// A plan that the pedestrians of a scene respond to.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenPlan {
    /// The path.
    pub plan: Plan,
    /// The pedestrian of the tracks who follows it; `None` for somebody who is not among them, such as a robot.
    pub ego: Option<PedestrianName>,
}

/// Joint futures instead of hypotheses, with what they were drawn from.
struct JointWalks<'a> {
    walked: Walked<'a>,
    parts: SceneParts,
    hypotheses: Forecast,
    /// `[N][K]`: where the hypotheses begin (m); or empty.
    starts: Vec<Position>,
}

impl<'a> Walked<'a> {
    fn joint(mut self, given: Option<&GivenPlan>) -> Result<JointWalks<'a>, ForecastError> {
        if self.hypotheses > JointScene::MOST_HYPOTHESES {
            let (found, most) = (self.hypotheses, JointScene::MOST_HYPOTHESES);
            return Err(ForecastError::model(NAME, SceneError::Hypotheses { found, most }));
        }
        let rolled_out = std::mem::take(&mut self.rolled_out);
        let paths = if self.factors.is_some() { self.walks(rolled_out, drop)?.0 } else { rolled_out };
        let marginal = self.at(paths)?;
        let scene = JointScene::of(self.window, &marginal, given.map(|given| &given.plan), self.ego(given));
        let (mixture, parts) = (scene.mixture(), scene.parts());
        let present = |pair: usize| self.window.observed(pair / self.hypotheses)[OBSERVED - 1];
        let begins = self.origins.iter().enumerate().map(|(pair, origin)| origin.map_or(present(pair), |(at, _)| at));
        let starts = begins.collect();
        let pairs = self.window.len() * self.hypotheses;
        let steps = || (0..pairs).flat_map(|pair| (0..HORIZON).map(move |t| (pair, t)));
        if self.factors.is_none() {
            let paths = steps().map(|(pair, t)| mixture.mean(pair, |i, h| marginal.hypothesis(i, h)[t]));
            self.rolled_out = paths.collect();
        }
        if let Some(factors) = &self.factors {
            let of_step = |i: usize, h: usize, t: usize| factors[(i * self.hypotheses + h) * HORIZON + t];
            let mixed = steps().map(|(pair, t)| mixture.mean(pair, |i, h| of_step(i, h, t)));
            self.factors = Some(mixed.collect());
        }
        if !self.origins.is_empty() {
            self.origins = (0..pairs).map(|pair| self.origins[mixture.largest(pair)]).collect();
        }
        let goals = (0..pairs).map(|pair| mixture.mean(pair, |i, h| self.goals[i * self.hypotheses + h]));
        self.goals = goals.collect();
        self.weights = mixture.weights.repeat(self.window.len());
        self.spread = spread(&marginal, &mixture);
        Ok(JointWalks { walked: self, parts, hypotheses: marginal, starts })
    }

    fn ego(&self, given: Option<&GivenPlan>) -> Option<usize> {
        self.window.named(given?.ego.as_ref()?)
    }

    /// The joint futures of these pedestrians, as an answer; the ego, if it is in the window, follows the plan in all
    /// of them.
    pub(crate) fn joint_answer(self, given: Option<&GivenPlan>, certificates: bool) -> Result<Answer, ForecastError> {
        let (window, ego) = (self.window, self.ego(given));
        let JointWalks { walked, parts, mut hypotheses, starts } = self.joint(given)?;
        let plan = given.map(|given| given.plan.clone());
        let (mut forecast, certificates) = walked.certified(certificates)?;
        if let (Some(ego), Some(plan)) = (ego, &plan) {
            [forecast, hypotheses] = [forecast, hypotheses].map(|forecast| forecast.with_path(ego, &planned(plan)));
        }
        let futures = Futures::of_parts(window, parts, hypotheses, starts, forecast, plan);
        Ok(Answer::of_scene(futures.map_err(|error| ForecastError::model(NAME, error))?, certificates))
    }
}

/// The futures of a joint forecast, where nothing else is known.
pub(crate) fn futures(window: &Window, forecast: Forecast) -> Result<Futures, ForecastError> {
    Futures::new(window, forecast, None).map_err(|error| ForecastError::model(NAME, error))
}

/// Where a plan is at the 12 steps, metres.
fn planned(plan: &Plan) -> [Position; HORIZON] {
    std::array::from_fn(|t| plan.at(TIME_STEP * (t + 1) as f64).position)
}

/// The spread around the paths of the futures: that around the hypotheses, and how far these are from their mixture.
fn spread(marginal: &Forecast, mixture: &JointMixture) -> Option<Spread> {
    let scales = mixture.scales(marginal)?;
    let paces = (0..marginal.pedestrians()).map(|i| marginal.pace(i)).collect::<Option<_>>()?;
    Some(Spread { scales, paces, regions: Calibration::shared_regions() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ddl_scene::PlanPoint;

    /// 1.2 m/s along x and -0.5 m/s along y: after 0.4 s for the first time.
    #[test]
    fn a_plan_is_read_at_the_steps_of_the_forecast() {
        let point = |time: f64| PlanPoint { time, position: [3.0 + 1.2 * time, 1.0 - 0.5 * time], radius: 0.3 };
        let path = planned(&Plan::new(vec![point(0.0), point(1.1), point(6.0)]).unwrap());
        for (t, [x, y]) in (1..).zip(path) {
            assert!((x - 3.0 - 0.48 * f64::from(t)).abs() < 1e-9 && (y - 1.0 + 0.2 * f64::from(t)).abs() < 1e-9);
        }
    }
}
