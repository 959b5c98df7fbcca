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

use crate::scored_window::ScoredWindow;

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
    pub fn of(scene: &ScoredWindow<'_>, i: usize) -> Option<Self> {
        let (forecast, k) = (scene.forecast(), scene.hypotheses());
        if k < 2 {
            return None;
        }
        let (mut path, mut ends) = (0.0, 0.0);
        for a in 0..k {
            for b in a + 1..k {
                let pairs = forecast.hypothesis(i, a).iter().zip(forecast.hypothesis(i, b));
                let mut steps = 0_usize;
                let (mut sum, mut last) = (0.0, 0.0);
                for (p, q) in pairs {
                    let (dx, dy) = (p[0] - q[0], p[1] - q[1]);
                    // The square of a position does not overflow, because coordinates are bounded.
                    last = (dx * dx + dy * dy).sqrt();
                    sum += last;
                    steps += 1;
                }
                path += sum / steps as f64;
                ends += last;
            }
        }
        let pairs = (k * (k - 1) / 2) as f64;
        Some(Self {
            path: path / pairs,
            ends: ends / pairs,
        })
    }
}
