//! AMD and AMV: how many deviations the truth lies from the forecast distribution, and how wide it is.
//!
//! For one pedestrian and one frame, with mean m and covariance C of the weighted hypotheses and the
//! true position p:
//!
//! ```text
//! Mahalanobis distance = sqrt((p - m)^T C^-1 (p - m))              deviations, no unit
//! AMD = mean over frames and pedestrians of it
//! AMV = largest eigenvalue of the mean over frames and pedestrians of C        square metres
//! ```
//!
//! The two belong together: a wider distribution has a smaller AMD and a larger AMV. Eigenvalues of C
//! below (1 cm)^2 are raised to it, in both: identical hypotheses, or hypotheses on one line, have no
//! inverse. A forecast of one hypothesis is no distribution. Where a forecast has a spread about its hypotheses, its variance is part of C.
//!
//! # Beside the published code
//! Social-Implicit draws 1,000 samples and fits a mixture of up to four Gaussians to them, as many as
//! the Bayesian information criterion says. Twenty weighted hypotheses are the distribution
//! themselves: here C and m are its own moments, a mixture of one component. That changes nothing in
//! AMV, because after an M step the total covariance of a mixture with full covariances, within the
//! components and between their means, is the covariance of the samples, whatever the number of
//! components. AMD is theirs wherever one component is chosen; with several,
//! theirs weighs the components along the way from the mean to the truth.
//!
//! Their paper writes AMV as the mean of the largest eigenvalues; their code, from which their numbers
//! are, takes the largest eigenvalue of the mean, and so does this one. It is never the larger of the
//! two. It adds pedestrians in world axes: of people who walk in all directions it sees a rounder
//! spread than each has.
//!
//! # References
//! Mohamed et al., "Social-Implicit: Rethinking Trajectory Prediction Evaluation and The Effectiveness
//! of Implicit Maximum Likelihood Estimation", ECCV 2022.

use ddl_data::HORIZON;

use super::{
    gaussian::{Covariance, Moments},
    kde::LEAST_DEVIATION,
};
use crate::Scene;

/// The distribution of one pedestrian's positions against the truth, mean over the frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistributionErrors {
    /// Mean Mahalanobis distance of the truth, deviations.
    pub mahalanobis: f64,
    /// Mean covariance, square metres.
    pub covariance: Covariance,
}

impl DistributionErrors {
    /// Of pedestrian `i`; `None` for forecasts of one hypothesis.
    #[must_use]
    pub fn of(scene: &Scene<'_>, i: usize) -> Option<Self> {
        if scene.hypotheses() < 2 {
            return None;
        }
        let weights = scene.weights(i);
        let (mut distance, mut covariance) = (0.0, Covariance::default());
        for (t, p) in scene.truth(i).iter().enumerate() {
            let moments = Moments::of(&scene.positions_at(i, t), &weights);
            let about = scene.forecast().spread(i, t).unwrap_or(0.0).powi(2);
            let axes = moments
                .covariance
                .plus(Covariance {
                    xx: about,
                    xy: 0.0,
                    yy: about,
                })
                .principal_axes()
                .raised_to(LEAST_DEVIATION * LEAST_DEVIATION);
            let off = [p[0] - moments.mean[0], p[1] - moments.mean[1]];
            distance += axes.mahalanobis_squared(off).sqrt();
            covariance = covariance.plus(axes.covariance());
        }
        Some(Self {
            mahalanobis: distance / HORIZON as f64,
            covariance: covariance.scaled(1.0 / HORIZON as f64),
        })
    }
}

/// AMV of a mean covariance: its largest eigenvalue, square metres.
///
/// # Examples
/// ```
/// use ddl_eval::metric::{amd::amv, gaussian::Moments};
///
/// // Two places 2 m apart, equally likely: a deviation of 1 m along x, none along y.
/// let moments = Moments::of(&[[-1.0, 0.0], [1.0, 0.0]], &[0.5, 0.5]);
/// assert!((amv(moments.covariance) - 1.0).abs() < 1e-12); // square metres
/// ```
#[must_use]
pub fn amv(mean_covariance: Covariance) -> f64 {
    mean_covariance.principal_axes().variances[0]
}
