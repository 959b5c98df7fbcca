//! Joint (scene-level) errors: one hypothesis index for everybody.
//!
//! ```text
//! JADE = min_k 1/N sum_i ADE_{i,k}        JFDE = min_k 1/N sum_i FDE_{i,k}        metres
//! ```
//!
//! Never smaller than the mean of the pedestrians' own minima. It is a fair question only to models whose hypothesis `k`
//! is one future of the scene; otherwise it measures the order in which hypotheses are listed.
//!
//! # References
//! Weng et al., "Joint Metrics Matter", ICCV 2023. Their averages are over scenes; here a scene counts
//! with its number of pedestrians, so that JADE and minADE are means over the same people.

use super::displacement::DisplacementErrors;

/// JADE of a scene, metres.
pub fn joint_ade(errors: &DisplacementErrors) -> f64 {
    least_scene_mean(errors, DisplacementErrors::ade)
}

/// JFDE of a scene, metres; its hypothesis may differ from that of [`joint_ade`].
pub fn joint_fde(errors: &DisplacementErrors) -> f64 {
    least_scene_mean(errors, DisplacementErrors::fde)
}

fn least_scene_mean(
    errors: &DisplacementErrors,
    of: fn(&DisplacementErrors, usize) -> &[f64],
) -> f64 {
    let n = errors.pedestrians();
    (0..errors.hypotheses())
        .map(|k| (0..n).map(|i| of(errors, i)[k]).sum::<f64>() / n as f64)
        .fold(f64::INFINITY, f64::min)
}
