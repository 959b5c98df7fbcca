//! The risk of a plan: how likely somebody comes close to it.
//!
//! In future k, of the weight `w_k`, pedestrian i is at `path_ik(t) + s_i(t) z_i`: the deviation `z_i` from its path is
//! distributed by Student's t ([`Spread`](ddl_core::Spread)), lasts for the whole future, grows with the scale `s_i(t)`
//! and is independent of those of other pedestrians. At the moment itself the scale is the deviation of the last
//! observed position, 0 for a row; between the steps and the rows of the plan everything moves on straight lines. With
//! the share `P_ik` of deviations that come close,
//!
//! ```text
//! P(somebody) = sum_k w_k (1 - prod_i (1 - P_ik)),    P(pedestrian i) = sum_k w_k P_ik
//! ```
//!
//! Shares are those of 64 deviations of equal probability (`quadrature.rs`), the same for every pedestrian and
//! future, so that results depend on nothing but their input. Less than 1/64 of one future may count as 0.

mod course;
mod crowd;
mod quadrature;
#[cfg(test)]
mod tests;

use crate::{energy::Energy, error::SceneError, futures::Futures, plan::Plan};
use course::legs;
use crowd::{CrowdAtRisk, Sweep};
use ddl_core::HORIZON;
use quadrature::DEVIATIONS;
pub(crate) use quadrature::probability;
use rayon::prelude::*;

/// Probabilities that somebody comes within a distance of the edge of a plan.
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
    /// A thousand plans among 25 pedestrians with 20 futures take some 20 ms on one core.
    /// The result does not depend on the number of threads, nor on which other plans there are.
    ///
    /// # Errors
    /// `within` is negative or not finite; the forecast has no spread.
    pub fn risks(&self, plans: &[Plan], within: f64, ego: Option<usize>) -> Result<Vec<Risk>, SceneError> {
        self.risks_with(plans, within, |_| vec![1.0; self.pedestrians()], ego)
    }

    /// [`risks`](Self::risks), where pedestrians see the plan and keep away from it as people do from each other.
    ///
    /// The odds that somebody comes close are divided by a factor learned from recordings in which a pedestrian plays
    /// the robot: a large one, and a small one for those who walk with the `ego`. The factor depends on the distance
    /// between centres, which is `within` plus the largest radius of the plan; from 1.5 m on it is 1. Pedestrians who
    /// are close at the moment itself, or may be, keep the probability of that, and those seen for the first time
    /// theirs.
    ///
    /// # Errors
    /// As [`risks`](Self::risks); the pedestrians were given a plan, which they respond to already.
    pub fn risks_if_seen(&self, plans: &[Plan], within: f64, ego: Option<usize>) -> Result<Vec<Risk>, SceneError> {
        if self.plan().is_some() {
            return Err(SceneError::PlanGiven);
        }
        let group = ego.and_then(|ego| self.groups().iter().find(|group| group.contains(&ego)));
        let odds = |plan: &Plan| {
            let radius = plan.points().iter().map(|point| point.radius).fold(0.0, f64::max);
            let [strangers, companions] = Energy::learned().avoidance(within + radius);
            let odds_of = |i: usize| if self.is_known(i) { 1.0 / strangers } else { 1.0 };
            let mut odds: Vec<f64> = (0..self.pedestrians()).map(odds_of).collect();
            for &companion in group.into_iter().flatten() {
                odds[companion] = 1.0 / companions;
            }
            odds
        };
        self.risks_with(plans, within, odds, ego)
    }

    fn risks_with(
        &self,
        plans: &[Plan],
        within: f64,
        odds: impl Fn(&Plan) -> Vec<f64> + Sync,
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
        Ok(plans.par_iter().map(|plan| self.risk(&crowd, &crowd.sweep(plan, within), &odds(plan), ego)).collect())
    }

    /// For each plan, the expected least distance of pedestrians from its edge if they do not see it, computed with the
    /// futures and deviations of [`risks`](Self::risks). A plan takes some 10 ms.
    ///
    /// # Errors
    /// The forecast has no spread.
    pub fn clearances(&self, plans: &[Plan]) -> Result<Vec<Clearance>, SceneError> {
        let crowd = CrowdAtRisk::new(self)?;
        Ok(plans.par_iter().map(|plan| self.clearance(&crowd, plan)).collect())
    }

    fn risk(&self, crowd: &CrowdAtRisk, sweep: &Sweep, odds: &[f64], ego: Option<usize>) -> Risk {
        let mut pedestrians = vec![0.0; self.pedestrians()];
        let [mut steps, mut until] = [[0.0; HORIZON]; 2];
        let near: Vec<usize> = crowd.near(sweep).into_iter().filter(|&i| Some(i) != ego).collect();
        for k in 0..self.count() {
            let weight = self.weight(k);
            let mut nobody: Option<[[f64; HORIZON]; 2]> = None;
            for &i in &near {
                let Some(hits) = crowd.hits(sweep, i, k) else { continue };
                // People who are close already cannot keep away. The odds that the others come close are divided by a
                // factor; the probability that they do so by an earlier step falls in proportion.
                let [close_now, close_later] = hits.until[HORIZON - 1];
                let of_others = close_later / f64::max(1.0 - close_now, f64::MIN_POSITIVE);
                let reduction = odds[i] / (1.0 - of_others + of_others * odds[i]);
                let nobody = nobody.get_or_insert([[1.0; HORIZON]; 2]);
                for (nobody, hits) in nobody.iter_mut().zip([&hits.steps, &hits.until]) {
                    for (nobody, [close_now, close_later]) in nobody.iter_mut().zip(hits) {
                        *nobody *= 1.0 - close_now - reduction * close_later;
                    }
                }
                pedestrians[i] += weight * (close_now + reduction * close_later);
            }
            for (sums, nobody) in [&mut steps, &mut until].into_iter().zip(nobody.iter().flatten()) {
                for (sum, nobody) in sums.iter_mut().zip(nobody) {
                    *sum += weight * (1.0 - nobody);
                }
            }
        }
        // The weights sum to 1 up to rounding.
        for probability in pedestrians.iter_mut().chain(&mut steps).chain(&mut until) {
            *probability = probability.min(1.0);
        }
        let total = until[HORIZON - 1];
        Risk { total, pedestrians, steps, until }
    }

    fn clearance(&self, crowd: &CrowdAtRisk, plan: &Plan) -> Clearance {
        let legs = legs(plan);
        let mut clearance = Clearance { nearest: 0.0, pedestrians: vec![0.0; self.pedestrians()] };
        for k in 0..self.count() {
            let weight = self.weight(k);
            let mut distances = Vec::with_capacity(self.pedestrians() * DEVIATIONS);
            for (i, expected) in clearance.pedestrians.iter_mut().enumerate() {
                let of_pedestrian = crowd.distances(&legs, i, k).map(|distance| distance.max(0.0));
                *expected += weight * of_pedestrian.iter().sum::<f64>() / DEVIATIONS as f64;
                distances.extend(of_pedestrian.map(|distance| (distance, i)));
            }
            clearance.nearest += weight * expected_least(distances, self.pedestrians());
        }
        clearance
    }
}

/// Expected least of N independent numbers, each equally likely one of its `DEVIATIONS` values, given with their index.
fn expected_least(mut values: Vec<(f64, usize)>, n: usize) -> f64 {
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut left = vec![DEVIATIONS; n];
    let (mut expected, mut above, mut before) = (0.0, 1.0, 0.0);
    for (value, i) in values {
        expected += above * (value - before);
        before = value;
        above *= (left[i] - 1) as f64 / left[i] as f64;
        left[i] -= 1;
        if left[i] == 0 {
            break;
        }
    }
    expected
}
