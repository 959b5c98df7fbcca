//! The likelihood of the truth under a kernel density of the hypotheses.
//!
//! For one pedestrian and one frame with the hypotheses `x_k` of weight `w_k` (sum 1) and the true position p, in d = 2
//! dimensions:
//!
//! ```text
//! n_eff = 1 / sum_k w_k^2                     effective number of hypotheses
//! h = n_eff^(-1 / (d + 4))                    Scott's factor
//! C = sum_k w_k (x_k - m)(x_k - m)^T / (1 - sum_k w_k^2)     unbiased covariance, square metres
//! H = h^2 C                                   bandwidth matrix, eigenvalues at least (1 cm)^2
//! ln f(p) = ln sum_k w_k N(p; x_k, H)         density per square metre
//! KDE NLL = - mean over frames and pedestrians of max(ln f(p), -20)        nats
//! ```
//!
//! This is `scipy.stats.gaussian_kde(x, weights=w).logpdf(p)`, clipped as in Trajectron++ and Social-Implicit, except
//! for the smallest bandwidth: eigenvalues of H below (1 cm)^2 are raised to it. Other implementations fail or skip the
//! frame in this case.
//!
//! A forecast with a [spread](ddl_core::Spread) is already a mixture, of Student's t around its hypotheses; its density
//! takes the place of f.
//!
//! Lower is better, and it may be negative. A forecast of one hypothesis has no density. The value depends strongly on
//! the number of hypotheses: values for 1,000 samples and for 20 are not comparable.
//!
//! # References
//! Ivanovic and Pavone, "The Trajectron", ICCV 2019 (KDE NLL); Salzmann et al., "Trajectron++", ECCV 2020; Mohamed et
//! al., "Social-Implicit", ECCV 2022; Scott, "Multivariate Density Estimation", 1992.

use ddl_core::{Position, Spread, distance};

use crate::metric::gaussian::PointMoments;
use crate::scored_window::ScoredWindow;

/// Lower bound of log densities, nats, so that one large error does not dominate the mean.
pub(crate) const MIN_LOG_DENSITY: f64 = -20.0;
/// Least deviation of a distribution of positions along any direction, metres.
pub(crate) const MIN_DEVIATION: f64 = 0.01;

/// `ln f(at)` of the kernel density of weighted points, nats for a density per square metre; not clipped.
///
/// # Panics
/// When the numbers of weights and points differ.
///
/// # Numerics
/// The sum of exponentials is taken relative to its largest term. If all weight is on one point, the covariance is 0/0
/// and is set to 0.
pub(crate) fn log_density(points: &[Position], weights: &[f64], position: Position) -> f64 {
    let moments = PointMoments::of(points, weights);
    let concentration: f64 = weights.iter().map(|w| w * w).sum();
    // 1 - sum of squares, without cancellation when one weight is nearly 1.
    let unbiased: f64 = weights.iter().map(|w| w * (1.0 - w)).sum();
    let scott = concentration.powf(1.0 / 6.0);
    let factor = if unbiased > 0.0 { scott * scott / unbiased } else { 0.0 };
    let bandwidth =
        moments.covariance.scaled(factor).principal_axes().with_least_eigenvalues(MIN_DEVIATION * MIN_DEVIATION);
    let normalisation = std::f64::consts::TAU.ln() + 0.5 * bandwidth.ln_determinant();
    log_sum(points, weights, |p| -0.5 * bandwidth.mahalanobis_squared([position[0] - p[0], position[1] - p[1]]))
        - normalisation
}

/// `ln f(at)` of the mixture of Student's t of this scale (m) around weighted points.
fn log_density_of_spread(points: &[Position], weights: &[f64], scale: f64, position: Position) -> f64 {
    let power = -0.5 * (Spread::DEGREES + 2.0);
    let exponent = |p: &Position| {
        let off = distance(*p, position) / scale;
        power * (off * off / Spread::DEGREES).ln_1p()
    };
    log_sum(points, weights, exponent) - (std::f64::consts::TAU * scale * scale).ln()
}

/// `ln sum_k w_k exp(exponent(x_k))`.
fn log_sum(points: &[Position], weights: &[f64], exponent: impl Fn(&Position) -> f64) -> f64 {
    let terms = || points.iter().zip(weights).filter(|(_, w)| **w > 0.0);
    let largest = terms().map(|(p, _)| exponent(p)).fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return largest;
    }
    let sum: f64 = terms().map(|(p, w)| w * (exponent(p) - largest).exp()).sum();
    largest + sum.ln()
}

/// Mean over the frames of -ln of the clipped density at the truth of pedestrian `i`, nats; `None` for one hypothesis.
pub fn kde_nll(scene: &ScoredWindow<'_>, i: usize) -> Option<f64> {
    if scene.hypotheses() < 2 {
        return None;
    }
    let weights = scene.weights(i);
    let truth = scene.truth(i);
    let sum: f64 = truth
        .iter()
        .enumerate()
        .map(|(t, &truth_position)| {
            let positions = scene.hypotheses_at(i, t);
            let density = match scene.forecast().scale(i, t) {
                None => log_density(&positions, &weights, truth_position),
                Some(scale) => log_density_of_spread(&positions, &weights, scale, truth_position),
            };
            density.max(MIN_LOG_DENSITY)
        })
        .sum();
    Some(-sum / truth.len() as f64)
}
