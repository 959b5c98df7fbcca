//! Reliability of probabilities: among goals of probability p, the share p should be nearest to the true endpoint.
//!
//! ```text
//! log loss = -1/N sum_i ln w_{i, k*(i)}      nats, k*(i) the hypothesis nearest the truth
//! ```
//!
//! Equal weights have ln K. Reference: Guo et al., *On calibration of modern neural networks*, ICML 2017.

use serde::{Deserialize, Serialize};

/// Number of bins of the reliability table, each with the same number of goals.
const BINS: usize = 10;
/// Smallest probability in the log loss.
const SMALLEST: f64 = 1e-6;

/// Reliability of the probabilities of many sets of hypotheses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reliability {
    /// Mean of -ln of the probability (at least 1e-6) given to the nearest hypothesis, nats.
    pub log_loss: f64,
    /// Log loss of equal probabilities: ln K, averaged over the sets.
    pub uniform_log_loss: f64,
    /// Mean over the bins of |predicted - observed|, weighted by their size.
    pub expected_error: f64,
    /// Bins by ascending probability; fewer than ten with few hypotheses.
    pub bins: Vec<ReliabilityBin>,
}

/// Hypotheses of about the same probability.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ReliabilityBin {
    /// Mean probability of the hypotheses.
    pub predicted: f64,
    /// Share of the hypotheses that were nearest to the truth.
    pub observed: f64,
    /// Number of hypotheses.
    pub count: usize,
}

impl Reliability {
    /// From sets of probabilities, each with the index of the hypothesis nearest to the truth.
    ///
    /// `None` without sets.
    ///
    /// # Panics
    /// When an index is out of range.
    pub fn of<'a>(sets: impl IntoIterator<Item = (&'a [f64], usize)>) -> Option<Self> {
        let mut hypotheses: Vec<(f64, bool)> = Vec::new();
        let (mut count, mut loss, mut uniform) = (0_usize, 0.0, 0.0);
        for (weights, nearest) in sets {
            count += 1;
            loss -= weights[nearest].max(SMALLEST).ln();
            uniform += (weights.len() as f64).ln();
            hypotheses.extend(weights.iter().enumerate().map(|(k, &w)| (w, k == nearest)));
        }
        if count == 0 {
            return None;
        }
        hypotheses.sort_by(|a, b| a.0.total_cmp(&b.0));
        let bin = |members: &[(f64, bool)]| {
            let size = members.len() as f64;
            ReliabilityBin {
                predicted: members.iter().map(|(w, _)| w).sum::<f64>() / size,
                observed: members.iter().filter(|(_, nearest)| *nearest).count() as f64 / size,
                count: members.len(),
            }
        };
        let bins: Vec<_> = hypotheses.chunks(hypotheses.len().div_ceil(BINS)).map(bin).collect();
        let off = |bin: &ReliabilityBin| (bin.predicted - bin.observed).abs() * bin.count as f64;
        Some(Self {
            log_loss: loss / count as f64,
            uniform_log_loss: uniform / count as f64,
            expected_error: bins.iter().map(off).sum::<f64>() / hypotheses.len() as f64,
            bins,
        })
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn probabilities_come_true_or_not() {
        let reliability = |weights: &[f64; 2], second: usize| {
            Reliability::of((0..400).map(|i| (&weights[..], usize::from(i % second == 0)))).unwrap()
        };
        let sound = reliability(&[0.75, 0.25], 4);
        assert_relative_eq!(sound.log_loss, -(0.75 * 0.75_f64.ln() + 0.25 * 0.25_f64.ln()), epsilon = 1e-12);
        assert_relative_eq!(sound.uniform_log_loss, 2.0_f64.ln(), epsilon = 1e-12);
        assert!(sound.expected_error < 0.01);
        assert_eq!(sound.bins.len(), 10);
        let overconfident = reliability(&[1.0, 0.0], 2);
        assert_relative_eq!(overconfident.expected_error, 0.5, epsilon = 1e-12);
        let log_loss = -0.5 * SMALLEST.ln();
        assert_relative_eq!(overconfident.log_loss, log_loss, epsilon = 1e-12);
        assert_eq!(Reliability::of([]), None);
        // 11 goals in bins of 2 and one of 1, predicted and observed: 0.15 and 0.5, 0.225 and 0.5, 0.325 and 0, 0.45
        // and 0.5, 0.85 and 0.5, 1 and 1.
        let sets: [(&[f64], usize); 5] =
            [(&[0.5, 0.3, 0.2], 0), (&[0.9, 0.1], 1), (&[0.4, 0.35, 0.25], 2), (&[0.8, 0.2], 0), (&[1.0], 0)];
        let uneven = Reliability::of(sets).unwrap();
        for (found, by_hand) in [
            (uneven.bins[0].predicted, 0.15),
            (uneven.expected_error, 2.0 * (0.35 + 0.275 + 0.325 + 0.05 + 0.35) / 11.0),
            (uneven.uniform_log_loss, 2.0 * 6.0_f64.ln() / 5.0),
            (uneven.log_loss, -(0.5 * 0.1 * 0.25 * 0.8_f64).ln() / 5.0),
        ] {
            assert_relative_eq!(found, by_hand, epsilon = 1e-12);
        }
    }
}
