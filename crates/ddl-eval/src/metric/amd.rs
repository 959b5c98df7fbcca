//! AMD and AMV: distance of the truth from the forecast distribution in deviations, and width of the distribution.
//!
//! For one pedestrian and one frame, with mean m and covariance C of the weighted hypotheses and the true position p:
//!
//! ```text
//! Mahalanobis distance = sqrt((p - m)^T C^-1 (p - m))              deviations, no unit
//! AMD = mean over frames and pedestrians of it
//! AMV = largest eigenvalue of the mean over frames and pedestrians of C        square metres
//! ```
//!
//! A wider distribution has a smaller AMD and a larger AMV. Eigenvalues of C below (1 cm)^2 are raised to it. AMD and
//! AMV need several hypotheses. A spread around the hypotheses adds its variance to C.
//!
//! # Differences from the published code
//! Social-Implicit fits a mixture of up to four Gaussians to 1,000 samples; here C and m are the moments of the
//! hypotheses. AMV does not depend on the number of components; AMD agrees with theirs when they choose one component.
//! As in their code, but not in their paper, AMV is the largest eigenvalue of the mean, which adds pedestrians in world
//! axes.
//!
//! # References
//! Mohamed et al., "Social-Implicit: Rethinking Trajectory Prediction Evaluation and The Effectiveness of Implicit
//! Maximum Likelihood Estimation", ECCV 2022.

use ddl_core::{HORIZON, Spread};

use crate::metric::gaussian::{PlaneCovariance, PointMoments};
use crate::metric::kde::MIN_DEVIATION;
use crate::scored_window::ScoredWindow;

/// The distribution of one pedestrian's positions against the truth, mean over the frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistributionErrors {
    /// Mean Mahalanobis distance of the truth, deviations.
    pub mahalanobis: f64,
    /// Mean covariance, square metres.
    pub covariance: PlaneCovariance,
}

impl DistributionErrors {
    /// The errors of pedestrian `i`; `None` for forecasts of one hypothesis.
    pub fn of(scene: &ScoredWindow<'_>, i: usize) -> Option<Self> {
        if scene.hypotheses() < 2 {
            return None;
        }
        let weights = scene.weights(i);
        let (mut distance, mut covariance) = (0.0, PlaneCovariance::default());
        for (t, p) in scene.truth(i).iter().enumerate() {
            let moments = PointMoments::of(&scene.hypotheses_at(i, t), &weights);
            // The variance of Student's t.
            let inflation = Spread::DEGREES / (Spread::DEGREES - 2.0);
            let about = inflation * scene.forecast().scale(i, t).unwrap_or(0.0).powi(2);
            let axes = moments
                .covariance
                .plus(PlaneCovariance { xx: about, xy: 0.0, yy: about })
                .principal_axes()
                .with_least_eigenvalues(MIN_DEVIATION * MIN_DEVIATION);
            distance += axes.mahalanobis_squared([p[0] - moments.mean[0], p[1] - moments.mean[1]]).sqrt();
            covariance = covariance.plus(axes.covariance());
        }
        Some(Self { mahalanobis: distance / HORIZON as f64, covariance: covariance.scaled(1.0 / HORIZON as f64) })
    }
}

/// AMV of a mean covariance: its largest eigenvalue, square metres.
pub(crate) fn amv(mean_covariance: PlaneCovariance) -> f64 {
    mean_covariance.principal_axes().variances[0]
}
