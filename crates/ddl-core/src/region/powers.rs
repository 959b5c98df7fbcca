//! Powers of the weights that follow the outcomes of one place.
//!
//! The weights of a forecast are raised to a power, one for each pace, and divided by their sum. When a forecast ends,
//! the power p moves so that the hypothesis j nearest to the true end becomes likelier, along the gradient of its log
//! weight:
//!
//! ```text
//! ln p += STEP * w * mean max(ln w_j - sum_k w_k ln w_k, -10)        w = share * min(sqrt(n), LARGEST_WEIGHT)
//! ```
//!
//! The mean is over the `n` pedestrians of this pace whose forecasts end at this frame; w as in
//! [`tracked`](super::tracked). ln p stays between -1.5 and 1.

use crate::forecast::Forecast;
use crate::pace::Pace;
use crate::position::{HORIZON, Position, distance};
use crate::region::tracked::weight_of;

/// Step size. Chosen on whole places left out (`docs/tried.md`).
const STEP: f64 = 0.01;
/// Bounds of ln p.
const BOUNDS: [f64; 2] = [-1.5, 1.0];

/// The logarithms of the powers, slowest pace first.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct TrackedPowers([f64; Pace::ALL.len()]);

impl TrackedPowers {
    /// Learns from the paces and [gradients](gradient) of forecasts that end at one frame, `share` of a step (0 to 1)
    /// after the frame before.
    pub(super) fn learn(&mut self, mut gradients: Vec<(Pace, f64)>, share: f64) {
        // The sum does not depend on the order of the pedestrians.
        gradients.sort_by(|a, b| a.1.total_cmp(&b.1));
        for (pace, log_power) in Pace::ALL.into_iter().zip(&mut self.0) {
            let own: Vec<f64> = gradients.iter().filter(|(of, _)| *of == pace).map(|g| g.1).collect();
            let mean = own.iter().sum::<f64>() / own.len().max(1) as f64;
            let moved = *log_power + STEP * weight_of(own.len(), share) * mean;
            *log_power = moved.clamp(BOUNDS[0], BOUNDS[1]);
        }
    }

    /// The forecast with its weights raised.
    pub(super) fn raised(&self, forecast: Forecast) -> Forecast {
        if *self == Self::default() {
            return forecast;
        }
        forecast.with_powers(|pace| self.0[pace as usize].exp())
    }
}

/// By how much a larger power would raise the log weight of the hypothesis nearest to the true end (m) of pedestrian
/// `i`; at least -10, also for a hypothesis of weight 0.
pub(super) fn gradient(forecast: &Forecast, i: usize, end: Position) -> f64 {
    let off = |k: usize| distance(forecast.hypothesis(i, k)[HORIZON - 1], end);
    let nearest = (0..forecast.hypotheses()).min_by(|&a, &b| off(a).total_cmp(&off(b)));
    let log = |k: usize| forecast.weight(i, k).max(f64::MIN_POSITIVE).ln();
    let mean: f64 = (0..forecast.hypotheses()).map(|k| forecast.weight(i, k) * log(k)).sum();
    nearest.map_or(0.0, |nearest| (log(nearest) - mean).max(-10.0))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;
    use crate::forecast::Spread;
    use crate::region_table::RegionTable;

    /// Two standing pedestrians with ends 0 and 5 m away, of the weights 0.8 and 0.2.
    fn forecast() -> Forecast {
        let positions = [[0.0, 0.0], [5.0, 0.0]].repeat(2).into_iter().flat_map(|end| [end; HORIZON]).collect();
        let bare = Forecast::new(2, 2, positions, [0.8, 0.2].repeat(2), None).unwrap();
        bare.with_spread(Spread {
            scales: vec![0.5; 2 * HORIZON],
            paces: vec![Pace::Standing, Pace::Walking],
            regions: RegionTable::of(&[&[[1.0; HORIZON]; 9]; 3], &[0.5]).unwrap().into(),
        })
        .unwrap()
    }

    /// By hand: the mean of ln w is 0.8 ln 0.8 + 0.2 ln 0.2 = -0.5004; ln 0.8 is 0.2773 above it.
    #[test]
    fn a_power_rises_for_its_own_pace_when_the_likeliest_was_right() {
        let forecast = forecast();
        let gradient = gradient(&forecast, 0, [0.4, 0.3]);
        assert!((gradient - 0.2 * 4.0_f64.ln()).abs() < 1e-12);
        let mut powers = TrackedPowers::default();
        powers.learn(vec![(Pace::Standing, gradient); 4], 0.5);
        let power = (0.01 * gradient).exp();
        let raised = powers.raised(forecast.clone());
        let expected = 0.8_f64.powf(power) / (0.8_f64.powf(power) + 0.2_f64.powf(power));
        assert!((raised.weight(0, 0) - expected).abs() < 1e-12 && expected > 0.8);
        assert!((raised.weight(1, 0) - 0.8).abs() < 1e-12, "another pace");
        assert_eq!(TrackedPowers::default().raised(forecast.clone()), forecast);
    }

    #[test]
    fn powers_stay_within_their_bounds() {
        for (gradient, expected) in [(9.0, 1.0), (-9.0, -1.5)] {
            let mut powers = TrackedPowers::default();
            for _ in 0..1000 {
                powers.learn(vec![(Pace::Slow, gradient); 20], 1.0);
            }
            assert_eq!(powers, TrackedPowers([0.0, expected, 0.0]));
        }
    }
}
