//! Errors of a single path for each pedestrian, as a program uses it, that is chosen without the truth.

use serde::{Deserialize, Serialize};

/// Share of the pedestrians whose errors count in [`DeployableErrors::worst_ade`].
const WORST: f64 = 0.05;

/// Means over pedestrians, metres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DeployableErrors {
    /// ADE.
    pub ade: f64,
    /// FDE.
    pub fde: f64,
    /// `CVaR95` of the ADE: its mean over the 5 % of the pedestrians with the largest, at least one.
    pub worst_ade: f64,
}

impl DeployableErrors {
    /// From ADE and FDE of each pedestrian, at least one.
    pub(crate) fn of(errors: impl Iterator<Item = [f64; 2]>) -> Self {
        let (mut ades, fdes): (Vec<f64>, Vec<f64>) = errors.map(|[ade, fde]| (ade, fde)).unzip();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let (ade, fde) = (mean(&ades), mean(&fdes));
        ades.sort_by(|a, b| b.total_cmp(a));
        let worst = (WORST * ades.len() as f64).round().max(1.0) as usize;
        Self { ade, fde, worst_ade: mean(&ades[..worst]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_of_forty_are_two() {
        let found = DeployableErrors::of((1..=40).map(|n| [f64::from(n), 2.0]));
        let (ade, fde, worst_ade) = (20.5, 2.0, 39.5);
        assert_eq!(found, DeployableErrors { ade, fde, worst_ade });
        assert!((DeployableErrors::of([[3.0, 4.0]].into_iter()).worst_ade - 3.0).abs() < 1e-12);
    }
}
