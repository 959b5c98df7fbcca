//! Diversity of the hypotheses of a pedestrian.
//!
//! ```text
//! APD_i = mean over pairs k < l of 1/T sum_t |x_k(t) - x_l(t)|        metres
//! FPD_i = mean over pairs k < l of |x_k(T) - x_l(T)|                  metres
//! ```
//!
//! It does not depend on the weights and the truth, so noise is diverse too. Diversity needs several hypotheses.
//!
//! # References
//! Yuan and Kitani, "`DLow`: Diversifying Latent Flows for Diverse Human Motion Prediction", ECCV 2020 (APD).

use ddl_core::{Forecast, average_displacement};

use crate::metric::displacement::final_displacement;

/// Mean distances between the hypotheses of one pedestrian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Diversity {
    /// Over the whole path, metres.
    pub path: f64,
    /// Between the ends, metres.
    pub ends: f64,
}

impl Diversity {
    /// The diversity of pedestrian `i`; `None` for forecasts of one hypothesis.
    pub fn of(forecast: &Forecast, i: usize) -> Option<Self> {
        let k = forecast.hypotheses();
        if k < 2 {
            return None;
        }
        let (mut path, mut ends) = (0.0, 0.0);
        for a in 0..k {
            for b in a + 1..k {
                let [one, other] = [a, b].map(|k| forecast.hypothesis(i, k));
                path += average_displacement(one, other);
                ends += final_displacement(one, other);
            }
        }
        let pairs = (k * (k - 1) / 2) as f64;
        Some(Self { path: path / pairs, ends: ends / pairs })
    }
}
