//! The metrics of one pedestrian of one window.

use crate::metric::amd::DistributionErrors;
use crate::metric::collision::{self, PEDESTRIAN_RADIUS, collides, collides_with_true_futures};
use crate::metric::displacement::{DisplacementErrors, expected, goal_fde};
use crate::metric::diversity::Diversity;
use crate::metric::kde::kde_nll;
use crate::metric::region::{RegionScores, weight_log_loss};
use crate::motion_kind::MotionKind;
use crate::scored_window::ScoredWindow;

/// Thresholds of the miss rate: 0.5 m, and those of other works; metres.
const MISS_DISTANCES: [f64; 3] = [0.5, 1.0, 2.0];

/// Lengths in metres.
pub(crate) struct PedestrianScores {
    pub(crate) min_ade: f64,
    pub(crate) min_fde: f64,
    pub(crate) fde_at_min_ade: f64,
    pub(crate) ade_at_min_fde: f64,
    pub(crate) expected_ade: f64,
    pub(crate) expected_fde: f64,
    pub(crate) most_likely_ade: f64,
    pub(crate) most_likely_fde: f64,
    /// ADE and FDE of the representative hypothesis.
    pub(crate) medoid: [f64; 2],
    /// Whether every hypothesis misses the endpoint by more than 0.5 m, 1 m and 2 m.
    pub(crate) missed: [bool; 3],
    pub(crate) collides: bool,
    pub(crate) truly_collides: bool,
    pub(crate) collides_with_true_futures: bool,
    pub(crate) goal_fde: Option<f64>,
    pub(crate) kde_nll: Option<f64>,
    pub(crate) distribution: Option<DistributionErrors>,
    pub(crate) diversity: Option<Diversity>,
    /// -ln of the weight of the hypothesis whose goal is nearest to the true endpoint, nats.
    pub(crate) weight_log_loss: Option<f64>,
    pub(crate) regions: Option<RegionScores>,
    pub(crate) familiarity: Option<f64>,
    /// ADE and FDE in the best future of the scene by each; `None` except under `joint`.
    pub(crate) joint: Option<[f64; 2]>,
    pub(crate) motion: Option<MotionKind>,
}

impl PedestrianScores {
    pub(crate) fn of(scene: &ScoredWindow<'_>, errors: &DisplacementErrors, joint: Option<[usize; 2]>) -> Vec<Self> {
        let forecast = scene.forecast();
        let collides_forecast = collides(&collision::representative_tracks(scene), PEDESTRIAN_RADIUS);
        let true_futures_collide = collision::true_futures_collide(scene, PEDESTRIAN_RADIUS);
        let collides_with_true_futures = collides_with_true_futures(scene, PEDESTRIAN_RADIUS);
        (0..scene.pedestrians())
            .map(|i| Self {
                medoid: [errors.ade(i), errors.fde(i)].map(|errors| errors[forecast.representative(i)]),
                min_ade: errors.min_ade(i),
                min_fde: errors.min_fde(i),
                fde_at_min_ade: errors.fde_at_min_ade(i),
                ade_at_min_fde: errors.ade_at_min_fde(i),
                expected_ade: expected(forecast, i, errors.ade(i)),
                expected_fde: expected(forecast, i, errors.fde(i)),
                most_likely_ade: errors.ade(i)[forecast.most_likely(i)],
                most_likely_fde: errors.fde(i)[forecast.most_likely(i)],
                missed: MISS_DISTANCES.map(|far| errors.min_fde(i) > far),
                collides: collides_forecast[i],
                truly_collides: true_futures_collide[i],
                collides_with_true_futures: collides_with_true_futures[i],
                goal_fde: goal_fde(scene, i),
                kde_nll: kde_nll(scene, i),
                distribution: DistributionErrors::of(scene, i),
                diversity: Diversity::of(forecast, i),
                weight_log_loss: weight_log_loss(scene, i),
                regions: RegionScores::of(scene, i),
                familiarity: forecast.familiarity(i),
                joint: joint.map(|[ade, fde]| [errors.ade(i)[ade], errors.fde(i)[fde]]),
                motion: MotionKind::of(scene.window().track(i)),
            })
            .collect()
    }
}
