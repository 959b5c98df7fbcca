//! Constants that determine how far a model is trusted. They are the same for all models; `docs/tried.md` describes how
//! they were chosen. `ddl-python/examples/regions.py` writes the regions in `calibration.json`, from places, each
//! forecast by a model that was not trained on it.

use ddl_core::{HORIZON, Pace, Position, RegionTable, mean_speed};
use ddl_goal::GoalSet;
use ddl_network::weights::in_hex;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::sync::{Arc, LazyLock};

/// The table from which the models make the regions of their forecasts.
#[must_use]
pub fn region_table() -> &'static RegionTable {
    &Calibration::fitted().regions
}

/// The constants of all models.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Calibration {
    /// Familiarity at which a model is half trusted.
    half_trust: f64,
    /// Share of the network's metric in the metric of a step, for a fully trusted motion.
    share: f64,
    /// Least scale of the spread around a hypothesis, metres.
    least_spread: f64,
    /// Exponent of the fraction of the horizon by which the spread grows.
    spread_growth: f64,
    /// What differs between paces.
    paces: OfPaces,
    /// Quantiles of the regions' scores.
    regions: RegionTable,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct OfPaces {
    standing: OfPace,
    slow: OfPace,
    walking: OfPace,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct OfPace {
    /// Power of the goals' weights without and with full trust.
    weight_power: [f64; 2],
    /// Share of the probability that is divided equally among the goals.
    uniform_share: f64,
    /// Scale of the spread at the horizon for each m/s of the mean observed speed, seconds.
    spread_of_speed: f64,
    /// Scale of the spread at the horizon for each metre of the goals' standard deviation (dimensionless).
    spread_of_goals: f64,
}

const FILE: &str = include_str!("calibration.json");
static FITTED: LazyLock<Option<Calibration>> = LazyLock::new(|| serde_json::from_str(FILE).ok());
static REGIONS: LazyLock<Arc<RegionTable>> = LazyLock::new(|| Arc::new(Calibration::fitted().regions.clone()));

impl Calibration {
    /// The constants that come with the program.
    ///
    /// # Panics
    /// Never: a test reads the file.
    pub(crate) fn fitted() -> &'static Self {
        #[expect(clippy::expect_used, reason = "the file is part of the program, and a test reads it")]
        FITTED.as_ref().expect("calibration.json holds the constants")
    }

    /// SHA-256 of the constants that come with the program.
    pub(crate) fn digest() -> String {
        let mut hasher = Sha256::new();
        hasher.update(FILE);
        in_hex(hasher)
    }

    pub(crate) fn shared_regions() -> Arc<RegionTable> {
        Arc::clone(&REGIONS)
    }

    /// Trust in a motion of this familiarity, 0 to 1.
    fn trust(&self, familiarity: f64) -> f64 {
        familiarity / (familiarity + self.half_trust)
    }

    pub(crate) fn share(&self, familiarity: f64) -> f64 {
        self.share * self.trust(familiarity)
    }

    fn of_pace(&self, pace: Pace) -> &OfPace {
        match pace {
            Pace::Standing => &self.paces.standing,
            Pace::Slow => &self.paces.slow,
            Pace::Walking => &self.paces.walking,
        }
    }

    /// The goals with the weights of a motion of this pace and familiarity.
    pub(crate) fn tempered(&self, goals: GoalSet, pace: Pace, familiarity: f64) -> GoalSet {
        let of_pace = self.of_pace(pace);
        let [without, with] = of_pace.weight_power;
        let power = without + (with - without) * self.trust(familiarity);
        goals.tempered(power, of_pace.uniform_share)
    }

    /// Scales of the [spread](ddl_core::Spread) around the positions of the hypotheses, one for each step (m). The
    /// pedestrian was observed at these positions (m), `time_step` seconds apart, and has these goals.
    pub(crate) fn spread(
        &self,
        pace: Pace,
        observed: &[Position],
        goals: &[Position],
        weights: &[f64],
        time_step: f64,
    ) -> [f64; HORIZON] {
        let of_pace = self.of_pace(pace);
        let of_speed = of_pace.spread_of_speed * mean_speed(observed, time_step);
        let at_end = of_speed + of_pace.spread_of_goals * deviation(goals, weights);
        std::array::from_fn(|t| {
            let share = (t + 1) as f64 / HORIZON as f64;
            self.least_spread.hypot(at_end * share.powf(self.spread_growth))
        })
    }
}

/// Standard deviation of weighted positions along an axis, averaged over all directions (root mean square), metres.
fn deviation(positions: &[Position], weights: &[f64]) -> f64 {
    let weighted = || positions.iter().zip(weights);
    let mean = weighted().fold([0.0; 2], |m, (p, w)| [m[0] + w * p[0], m[1] + w * p[1]]);
    let off = |p: &Position| (p[0] - mean[0]).hypot(p[1] - mean[1]);
    let variance: f64 = weighted().map(|(p, w)| w * off(p) * off(p)).sum();
    (0.5 * variance).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ddl_goal::HeadingFrame;

    #[test]
    fn the_constants_can_be_read_and_are_in_range() {
        let fitted = Calibration::fitted();
        let [low, high] = fitted.regions.range();
        assert!(low <= 0.05 && high >= 0.99);
        assert!(fitted.half_trust > 0.0 && (0.0..=1.0).contains(&fitted.share));
        for of_pace in Pace::ALL.map(|pace| fitted.of_pace(pace)) {
            assert!((0.0..1.0).contains(&of_pace.uniform_share));
            assert!(of_pace.weight_power.iter().all(|power| *power > 0.0));
        }
    }

    /// 1 m/s along a diagonal. The mean of the goals is (4, 1), and 7 m^2 the sum of their variances along x and y.
    /// With the trust 0.75 / (0.75 + 0.25) the power of the weights is 0.5 + 0.75 * 2 = 2: 0.25, 0.09 and 0.04 of 0.38.
    #[test]
    fn spread_weights_and_shares_by_hand() {
        let mut calibration = Calibration {
            half_trust: 0.25,
            share: 0.8,
            least_spread: 0.3,
            spread_growth: 0.5,
            ..Calibration::fitted().clone()
        };
        let OfPaces { standing, slow, walking } = &mut calibration.paces;
        for (of_pace, speed) in [(standing, 1.0), (slow, 2.0), (walking, 0.1)] {
            of_pace.spread_of_speed = speed;
            of_pace.spread_of_goals = 0.2;
            (of_pace.weight_power, of_pace.uniform_share) = ([0.5, 2.5], 0.1 * speed);
        }
        let observed: Vec<Position> = (0..8).map(|t| [0.3 * f64::from(t), 2.0 - 0.4 * f64::from(t)]).collect();
        let (goals, weights) = ([[5.0, 3.0], [5.0, -1.0], [1.0, -1.0]], [0.5, 0.25, 0.25]);
        let frame = HeadingFrame::new(&observed).unwrap();
        let set = GoalSet::from_endpoints(&frame, &goals, &[0.5, 0.3, 0.2], 3).unwrap();
        for (pace, speed) in Pace::ALL.into_iter().zip([1.0, 2.0, 0.1]) {
            let spread = calibration.spread(pace, &observed, &goals, &weights, 0.5);
            let at_end = speed + 0.2 * 3.5_f64.sqrt();
            let tempered = calibration.tempered(set.clone(), pace, 0.75);
            let weight = |share: f64| (1.0 - 0.1 * speed) * share / 0.38 + 0.1 * speed / 3.0;
            for (found, expected) in [
                (spread[11], at_end.hypot(0.3)),
                (spread[2], (at_end / 2.0).hypot(0.3)),
                (tempered.weights()[0], weight(0.25)),
                (tempered.weights()[2], weight(0.04)),
                (calibration.share(0.75), 0.6),
            ] {
                assert!((found - expected).abs() < 1e-9, "{pace:?}: {found} {expected}");
            }
        }
    }
}
