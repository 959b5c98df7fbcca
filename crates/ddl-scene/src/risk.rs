//! The risk of a plan: how likely somebody comes close to it.
//!
//! A pedestrian i that follows its hypothesis h is at `path_ih(t) + s_i(t) z_i`: the deviation `z_i` from its path is
//! distributed by Student's t ([`Spread`](ddl_core::Spread)), lasts for the whole future, grows with the scale `s_i(t)`
//! and is independent of those of other pedestrians. At the moment itself the scale is the deviation of the last
//! observed position, 0 for a row; between the steps and the rows of the plan everything moves on straight lines. With
//! the share `P_ih` of deviations that come close, and the share `w_ih` of samples of the scene in which i follows h,
//!
//! ```text
//! P(pedestrian i) = sum_h w_ih P_ih,    P(somebody) = 1 - prod_i (1 - P(pedestrian i))
//! ```
//!
//! as if people came close independently of each other: sums over the samples were no better calibrated, and slower.
//! Pedestrians who see a plan respond to it (`response.rs`): the odds that each comes close are divided by a factor,
//! and the hypotheses of those who walk with the pedestrian on the plan get other weights.
//!
//! Shares are those of 64 deviations of equal probability (`quadrature.rs`), others for each hypothesis, so that
//! results depend on nothing but their input. Less than 1/64 of a hypothesis may count as 0.

mod course;
mod crowd;
mod quadrature;
mod response;
#[cfg(test)]
mod tests;
mod way;

use crate::{error::SceneError, futures::Futures, plan::Plan};
use course::legs;
use crowd::{CrowdAtRisk, Hits, Sweep};
use ddl_core::HORIZON;
pub(crate) use quadrature::probability;
use rayon::prelude::*;
use response::{PlanResponse, Response, SeenPlan, responses};
use std::array::from_fn;
use std::borrow::Cow;

/// Probabilities that somebody comes within a distance of the edge of a plan, as if people did so independently.
#[derive(Debug, Clone, PartialEq)]
pub struct Risk {
    /// That somebody does, from the moment to 4.8 s after it.
    pub total: f64,
    /// `[N]`: that this pedestrian does.
    pub pedestrians: Vec<f64>,
    /// That somebody is so close during this step of 0.4 s.
    pub steps: [f64; HORIZON],
    /// That somebody was so close by the end of this step; the last one is the total.
    pub until: [f64; HORIZON],
}

/// Expected least distance (m) of pedestrians, who do not see a plan, from its edge, over 4.8 s; 0 where they touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Clearance {
    /// Of the pedestrian that comes nearest.
    pub nearest: f64,
    /// `[N]`: of each pedestrian.
    pub pedestrians: Vec<f64>,
}

impl Futures {
    /// For each plan, how likely somebody comes within `within` metres of its edge, if nobody sees it. The pedestrian
    /// `ego` who follows the plan, if there is one, is no risk to itself.
    ///
    /// The result does not depend on the number of threads, nor on which other plans there are.
    ///
    /// # Errors
    /// `within` is negative or not finite; the forecast has no spread.
    pub fn risks(&self, plans: &[Plan], within: f64, ego: Option<usize>) -> Result<Vec<Risk>, SceneError> {
        self.risks_with(plans, within, &[], ego)
    }

    /// [`risks`](Self::risks), where pedestrians see the plan and keep away from it as people do from each other.
    ///
    /// The odds that a stranger comes close are divided by a factor learned from recordings in which a pedestrian plays
    /// the robot. Those who walk with the `ego` move as far as the plan does, at the distance that they kept. The
    /// factor depends on the distance between centres, which is `within` plus the largest radius of the plan; of
    /// strangers it is 1 from 1.5 m on. Pedestrians who are close at the moment itself, or may be, keep the probability
    /// of that, and those seen for the first time theirs.
    ///
    /// # Errors
    /// As [`risks`](Self::risks); the pedestrians were given a plan, which they respond to already.
    pub fn risks_if_seen(&self, plans: &[Plan], within: f64, ego: Option<usize>) -> Result<Vec<Risk>, SceneError> {
        if self.plan().is_some() {
            return Err(SceneError::PlanGiven);
        }
        self.risks_with(plans, within, &responses(self, ego), ego)
    }

    fn risks_with(
        &self,
        plans: &[Plan],
        within: f64,
        responses: &[Response],
        ego: Option<usize>,
    ) -> Result<Vec<Risk>, SceneError> {
        if !(within >= 0.0 && within.is_finite()) {
            return Err(SceneError::Number {
                name: "the distance that counts as close",
                value: within,
                expected: "a number of metres, 0 or more",
            });
        }
        let crowd = CrowdAtRisk::new(self)?;
        let risk = |plan: &Plan| {
            let seen = SeenPlan::new(plan, within);
            let respond = |i: usize| responses.get(i).unwrap_or(&Response::None).to(&seen, self, i);
            self.risk(&crowd, &crowd.sweep(plan, within), respond, ego)
        };
        Ok(plans.par_iter().map(risk).collect())
    }

    /// For each plan, the expected least distance of pedestrians from its edge if they do not see it, computed with the
    /// hypotheses and deviations of [`risks`](Self::risks).
    ///
    /// # Errors
    /// The forecast has no spread.
    pub fn clearances(&self, plans: &[Plan]) -> Result<Vec<Clearance>, SceneError> {
        let crowd = CrowdAtRisk::new(self)?;
        Ok(plans.par_iter().map(|plan| self.clearance(&crowd, plan)).collect())
    }

    fn risk(
        &self,
        crowd: &CrowdAtRisk,
        sweep: &Sweep,
        respond: impl Fn(usize) -> PlanResponse,
        ego: Option<usize>,
    ) -> Risk {
        let mut pedestrians = vec![0.0; self.pedestrians()];
        // During each step, then until its end: the probability that no pedestrian comes close, the product of those of
        // each. A product of numbers up to 1 cannot rise, so `until` cannot fall by rounding.
        let mut none_close = [1.0; 2 * HORIZON];
        for i in crowd.near(sweep).filter(|&i| Some(i) != ego) {
            let PlanResponse { factors, odds } = respond(i);
            let Some(hits) = crowd.hits(sweep, i, &reweighted(&crowd.shares[i], &factors)) else { continue };
            // The weights sum to 1 up to rounding.
            let of_one = reduced(&hits, odds).map(|probability| probability.min(1.0));
            pedestrians[i] = of_one[2 * HORIZON - 1];
            for (none_close, is_close) in none_close.iter_mut().zip(of_one) {
                *none_close *= 1.0 - is_close;
            }
        }
        let somebody = none_close.map(|probability| 1.0 - probability);
        let [steps, until] = [0, HORIZON].map(|from| from_fn(|step| somebody[from + step]));
        Risk { total: somebody[2 * HORIZON - 1], pedestrians, steps, until }
    }

    fn clearance(&self, crowd: &CrowdAtRisk, plan: &Plan) -> Clearance {
        let legs = legs(plan);
        let of_each = |i: usize| -> Vec<Vec<f64>> {
            (0..self.hypotheses().hypotheses()).map(|k| crowd.distances(&legs, i, k)).collect()
        };
        // Of each pedestrian and hypothesis.
        let mut distances: Vec<Vec<Vec<f64>>> = (0..self.pedestrians()).map(of_each).collect();
        distances.iter_mut().flatten().flatten().for_each(|distance| *distance = distance.max(0.0));
        let mean = |distances: &Vec<f64>| distances.iter().sum::<f64>() / distances.len() as f64;
        let expected = distances.iter().zip(&crowd.shares).map(|(distances, shares)| {
            distances.iter().zip(shares).map(|(distances, share)| share * mean(distances)).sum()
        });
        // Somebody is surely nearer than this.
        let most = |distances: &Vec<Vec<f64>>| distances.iter().flatten().copied().fold(0.0, f64::max);
        let width = (distances.iter().map(most).fold(f64::INFINITY, f64::min) / CELLS as f64).max(f64::MIN_POSITIVE);
        let mut farther = [1.0; CELLS];
        for (distances, shares) in distances.iter().zip(&crowd.shares) {
            let of_one = farther_shares(distances, shares, width);
            farther.iter_mut().zip(of_one).for_each(|(farther, of_one)| *farther *= of_one);
        }
        Clearance { nearest: width * farther.iter().sum::<f64>(), pedestrians: expected.collect() }
    }
}

/// Cells of distance over which the least one is integrated.
const CELLS: usize = 256;

/// In each cell of this width (m), from 0 on, the mean share of distances of a pedestrian that are larger.
fn farther_shares(distances: &[Vec<f64>], shares: &[f64], width: f64) -> [f64; CELLS] {
    // Of each cell what is less than in the one before.
    let mut less = [0.0; CELLS + 2];
    for (distances, share) in distances.iter().zip(shares) {
        for distance in distances {
            let (end, share) = (distance / width, share / distances.len() as f64);
            let cell = (end as usize).min(CELLS);
            less[cell] += (1.0 - end.fract()) * share;
            less[cell + 1] += end.fract() * share;
        }
    }
    let mut farther = 1.0;
    from_fn(|cell| {
        farther = f64::max(farther - less[cell], 0.0);
        farther
    })
}

/// Probabilities during each step, then until its end.
type StepProbabilities = [f64; 2 * HORIZON];

/// What remains of probabilities if a pedestrian multiplies its odds to come close by a factor. Whoever is close at the
/// moment itself cannot keep away; the probability of the others falls in proportion, by each step.
fn reduced(hits: &Hits, odds: f64) -> StepProbabilities {
    let [close_now, close_later] = hits[2 * HORIZON - 1];
    let of_others = close_later / f64::max(1.0 - close_now, f64::MIN_POSITIVE);
    let reduction = odds / (1.0 - of_others + of_others * odds);
    hits.map(|[now, later]| now + reduction * later)
}

/// Probabilities times factors, divided by their sum.
fn reweighted<'a>(shares: &'a [f64], factors: &[f64]) -> Cow<'a, [f64]> {
    let products = || shares.iter().zip(factors).map(|(share, factor)| share * factor);
    let total: f64 = products().sum();
    if total > 0.0 { products().map(|product| product / total).collect() } else { shares.into() }
}
