//! Joint (scene-level) errors: one hypothesis index for everybody.
//!
//! ```text
//! JADE = min_k 1/N sum_i ADE_{i,k}        JFDE = min_k 1/N sum_i FDE_{i,k}        metres
//! ```
//!
//! Never smaller than the mean of the pedestrians' own minima: choosing one future for the whole
//! scene is harder than choosing one for each person. It is a fair question only to models whose
//! hypothesis `k` is one future of the scene; where the hypotheses of two people are unrelated (one
//! goal each, say) JADE measures the order they happen to be listed in.
//!
//! # References
//! Weng et al., "Joint Metrics Matter", ICCV 2023. Their averages are over scenes; here a scene counts
//! with its number of pedestrians, so that JADE and minADE are means over the same people.

use super::displacement::DisplacementErrors;

/// JADE of a scene, metres.
///
/// # Examples
/// ```
/// use ddl_data::{PedestrianId, Window};
/// use ddl_eval::metric::{displacement::DisplacementErrors, joint::joint_ade};
/// use ddl_eval::{Forecast, Scene};
///
/// let still = vec![[0.0, 0.0]; 20];
/// let ids = vec![PedestrianId(1), PedestrianId(2)];
/// let window = Window::new("yard", 0, 10, ids, vec![still.clone(), still])?;
/// // The first pedestrian's hypotheses are off by 0 m and 1 m, the second's by 1 m and 0.5 m.
/// let off = [0.0, 1.0, 1.0, 0.5].into_iter().flat_map(|off| [[off, 0.0]; 12]).collect();
/// let forecast = Forecast::equally_likely(2, 2, off)?;
/// let errors = DisplacementErrors::of(&Scene::new(&window, &forecast)?);
/// assert_eq!(joint_ade(&errors), 0.5); // the first for both: (0 + 1) / 2; the second: (1 + 0.5) / 2
/// assert_eq!((errors.min_ade(0) + errors.min_ade(1)) / 2.0, 0.25);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn joint_ade(errors: &DisplacementErrors) -> f64 {
    least_scene_mean(errors, DisplacementErrors::ade)
}

/// JFDE of a scene, metres; its hypothesis may differ from that of [`joint_ade`].
#[must_use]
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
