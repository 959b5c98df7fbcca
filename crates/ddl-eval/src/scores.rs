//! All metrics of a test set in one value.

use ddl_core::{Forecast, Window};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::category_scores::CategoryScores;
use crate::error::{EvaluationError, WindowProblem};
use crate::metric::amd::amv;
use crate::metric::deployable::DeployableErrors;
use crate::metric::displacement::DisplacementErrors;
use crate::metric::gaussian::PlaneCovariance;
use crate::metric::joint::{JointScores, SceneFutures};
use crate::metric::stability::{self, RolloutStability, StabilityScores};
use crate::pedestrian_scores::PedestrianScores;
use crate::protocol::Protocol;
use crate::scored_window::ScoredWindow;

/// The metrics of one forecaster on the test windows of one fold.
///
/// Means are over pedestrians; a pedestrian in several windows counts once for each. Fields missing in files of earlier
/// versions are `None`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Scores {
    /// Pedestrians scored, over all windows.
    pub pedestrians: usize,
    /// Windows scored.
    pub windows: usize,
    /// Hypotheses of each pedestrian, K.
    pub hypotheses: usize,
    /// minADE over K, metres.
    pub min_ade: f64,
    /// minFDE over K, a separate minimum, metres.
    pub min_fde: f64,
    /// FDE of the hypothesis with the smallest ADE, metres.
    pub fde_at_min_ade: f64,
    /// JADE: one hypothesis index for the whole scene, metres.
    pub joint_ade: f64,
    /// JFDE, metres.
    pub joint_fde: f64,
    /// Share of pedestrians for whom every hypothesis ends more than 0.5 m from the true endpoint, in [0, 1].
    pub miss_rate: f64,
    /// Share of pedestrians whose representative forecast collides with another's, in [0, 1].
    pub collision_rate: f64,
    /// Share of pedestrians whose true future collides with another's, in [0, 1].
    pub true_collision_rate: f64,
    /// Distance of the nearest goal from the true endpoint, metres; `None` for forecasts without goals.
    pub goal_fde: Option<f64>,
    /// Behaviour of the rollouts towards their goals; `None` for forecasts without goals.
    pub stability: Option<StabilityScores>,
    /// ADE of the hypothesis with the smallest FDE, metres.
    pub ade_at_min_fde: Option<f64>,
    /// Weighted mean ADE of all hypotheses, metres.
    pub expected_ade: Option<f64>,
    /// Weighted mean FDE of all hypotheses, metres.
    pub expected_fde: Option<f64>,
    /// ADE of the most likely hypothesis, metres.
    pub most_likely_ade: Option<f64>,
    /// FDE of the most likely hypothesis, metres.
    pub most_likely_fde: Option<f64>,
    /// Errors of the most likely hypothesis.
    pub likeliest: Option<DeployableErrors>,
    /// Errors of the representative hypothesis, the medoid.
    pub medoid: Option<DeployableErrors>,
    /// As [`miss_rate`](Self::miss_rate), by more than 1 m.
    pub miss_rate_1m: Option<f64>,
    /// As [`miss_rate`](Self::miss_rate), by more than 2 m.
    pub miss_rate_2m: Option<f64>,
    /// Share of pedestrians whose representative forecast collides with another's true future, in [0, 1].
    pub true_neighbour_collision_rate: Option<f64>,
    /// Negative log-likelihood of the truth under a kernel density of the hypotheses, nats; `None` for one hypothesis.
    pub kde_nll: Option<f64>,
    /// Average Mahalanobis distance of the truth, deviations; `None` for one hypothesis.
    pub amd: Option<f64>,
    /// Average maximum eigenvalue: spread of the hypotheses, square metres; `None` for one hypothesis.
    pub amv: Option<f64>,
    /// Mean distance between the paths of two hypotheses, metres; `None` for one hypothesis.
    pub diversity: Option<f64>,
    /// Mean distance between the ends of two hypotheses, metres; `None` for one hypothesis.
    pub end_diversity: Option<f64>,
    /// Mean of -ln of the weight of the hypothesis whose goal is nearest to the true endpoint, nats; `None` for one
    /// hypothesis.
    pub weight_log_loss: Option<f64>,
    /// Share of true positions inside the regions of 50 % and of 90 %, in [0, 1]; `None` for forecasts without regions.
    pub coverage: Option<[f64; 2]>,
    /// Mean radius of a disc with the area of these regions at the last step, metres.
    pub region_radius: Option<[f64; 2]>,
    /// Mean familiarity of the observed motions, 0 to 1; `None` for forecasters that do not give it.
    pub familiarity: Option<f64>,
    /// Metrics of whole futures; `None` except under `joint`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<JointScores>,
    /// The pedestrians by kind of motion, in the order of [`MotionKind::ALL`](crate::MotionKind::ALL).
    #[serde(default)]
    pub categories: Vec<CategoryScores>,
}

impl Scores {
    /// Scores the forecasts of all windows, one for each window.
    ///
    /// The result does not depend on the number of threads.
    ///
    /// # Errors
    /// There are no windows, a window has no future, or a forecast does not belong to its window. The forecasts differ
    /// in their number of hypotheses, in having goals or in having certificates.
    pub fn evaluate(windows: &[Window], forecasts: &[Forecast]) -> Result<Self, EvaluationError> {
        Self::under(Protocol::Fair, windows, windows, forecasts)
    }

    /// The two errors that tables of a protocol begin with, metres: JADE and JFDE under `joint`, else minADE and
    /// minFDE.
    pub fn errors(&self, protocol: Protocol) -> [f64; 2] {
        match protocol {
            Protocol::Joint => [self.joint_ade, self.joint_fde],
            _ => [self.min_ade, self.min_fde],
        }
    }

    /// [`Scores::evaluate`] for a part of the pedestrians, with the metrics of whole futures under `joint`;
    /// `full_windows` holds the full window of each.
    ///
    /// Means are over the part. Collisions with true futures include all pedestrians. The collision
    /// rate, JADE and JFDE compare forecasts, so they include only the pedestrians with forecasts.
    ///
    /// # Errors
    /// As [`Scores::evaluate`]; also when a full window does not belong to the reduced one.
    pub fn under(
        protocol: Protocol,
        windows: &[Window],
        full_windows: &[Window],
        forecasts: &[Forecast],
    ) -> Result<Self, EvaluationError> {
        if full_windows.len() != windows.len() {
            let (windows, full_windows) = (windows.len(), full_windows.len());
            return Err(EvaluationError::FullWindowCount { windows, full_windows });
        }
        EvaluationError::unless_one_each(windows, forecasts.len())?;
        let first = forecasts.first().ok_or(EvaluationError::NoWindows)?;
        let scenes: Vec<SceneScores> = windows
            .par_iter()
            .zip(full_windows)
            .zip(forecasts)
            .map(|((window, full_window), forecast)| {
                check_alike(window, forecast, first)?;
                let scene = ScoredWindow::new(window, forecast)?.among(full_window)?;
                Ok(SceneScores::of(&scene, protocol))
            })
            .collect::<Result<_, EvaluationError>>()?;
        Ok(Self::mean(&scenes, first))
    }

    fn mean(scenes: &[SceneScores], first: &Forecast) -> Self {
        let pedestrians: usize = scenes.iter().map(|s| s.pedestrians.len()).sum();
        let total = pedestrians as f64;
        let over_scenes = |metric: fn(&SceneScores) -> f64| scenes.iter().map(metric).sum::<f64>() / total;
        let mean = |metric: fn(&PedestrianScores) -> f64| {
            let sum = |s: &SceneScores| s.pedestrians.iter().map(metric).sum::<f64>();
            scenes.iter().map(sum).sum::<f64>() / total
        };
        let share = |holds: fn(&PedestrianScores) -> bool| {
            scenes.iter().flat_map(|s| &s.pedestrians).filter(|pedestrian| holds(pedestrian)).count() as f64 / total
        };
        let each = || scenes.iter().flat_map(|s| &s.pedestrians);
        let futures = scenes.iter().map(|s| (s.pedestrians.len(), s.joint, s.futures.as_ref()));
        // All pedestrians have the same number of hypotheses, so either all or none have a distribution.
        let several = first.hypotheses() > 1;
        let of_several = |metric: fn(&PedestrianScores) -> Option<f64>| {
            let sum = |s: &SceneScores| s.pedestrians.iter().filter_map(metric).sum::<f64>();
            several.then(|| scenes.iter().map(sum).sum::<f64>() / total)
        };
        let rollouts: Vec<RolloutStability> = scenes.iter().flat_map(|s| s.rollouts.iter().copied()).collect();
        Self {
            pedestrians,
            windows: scenes.len(),
            hypotheses: first.hypotheses(),
            min_ade: mean(|w| w.min_ade),
            min_fde: mean(|w| w.min_fde),
            fde_at_min_ade: mean(|w| w.fde_at_min_ade),
            joint_ade: over_scenes(|s| s.joint[0]),
            joint_fde: over_scenes(|s| s.joint[1]),
            miss_rate: share(|w| w.missed[0]),
            collision_rate: share(|w| w.collides),
            true_collision_rate: share(|w| w.truly_collides),
            goal_fde: first.has_goals().then(|| mean(|w| w.goal_fde.unwrap_or(0.0))),
            stability: StabilityScores::mean(&rollouts),
            ade_at_min_fde: Some(mean(|w| w.ade_at_min_fde)),
            expected_ade: Some(mean(|w| w.expected_ade)),
            expected_fde: Some(mean(|w| w.expected_fde)),
            most_likely_ade: Some(mean(|w| w.most_likely_ade)),
            most_likely_fde: Some(mean(|w| w.most_likely_fde)),
            likeliest: Some(DeployableErrors::of(each().map(|w| [w.most_likely_ade, w.most_likely_fde]))),
            medoid: Some(DeployableErrors::of(each().map(|w| w.medoid))),
            miss_rate_1m: Some(share(|w| w.missed[1])),
            miss_rate_2m: Some(share(|w| w.missed[2])),
            true_neighbour_collision_rate: Some(share(|w| w.collides_with_true_futures)),
            kde_nll: of_several(|w| w.kde_nll),
            amd: of_several(|w| w.distribution.map(|d| d.mahalanobis)),
            amv: several.then(|| amv(mean_covariance(scenes, total))),
            diversity: of_several(|w| w.diversity.map(|d| d.path)),
            end_diversity: of_several(|w| w.diversity.map(|d| d.ends)),
            weight_log_loss: of_several(|w| w.weight_log_loss),
            coverage: of_all(scenes, total, |w| Some(w.regions?.coverage)),
            region_radius: of_all(scenes, total, |w| Some(w.regions?.end_radius)),
            familiarity: of_all(scenes, total, |w| w.familiarity.map(|f| [f])).map(|[f]| f),
            joint: JointScores::of(futures),
            categories: CategoryScores::of(scenes.iter().flat_map(|s| &s.pedestrians)),
        }
    }
}

fn of_all<const N: usize>(
    scenes: &[SceneScores],
    total: f64,
    metric: impl Fn(&PedestrianScores) -> Option<[f64; N]>,
) -> Option<[f64; N]> {
    let mut pedestrians = scenes.iter().flat_map(|s| &s.pedestrians);
    let sum = pedestrians.try_fold([0.0; N], |sum, pedestrian| {
        let more = metric(pedestrian)?;
        Some(std::array::from_fn(|n| sum[n] + more[n]))
    })?;
    Some(sum.map(|sum| sum / total))
}

fn mean_covariance(scenes: &[SceneScores], pedestrians: f64) -> PlaneCovariance {
    let of_scene = |s: &SceneScores| {
        let covariances = s.pedestrians.iter().filter_map(|w| w.distribution);
        covariances.fold(PlaneCovariance::default(), |sum, d| sum.plus(d.covariance))
    };
    scenes.iter().map(of_scene).fold(PlaneCovariance::default(), PlaneCovariance::plus).scaled(1.0 / pedestrians)
}

fn check_alike(window: &Window, forecast: &Forecast, first: &Forecast) -> Result<(), EvaluationError> {
    let (expected, found) = (first.hypotheses(), forecast.hypotheses());
    let problem = if found != expected {
        WindowProblem::Hypotheses { expected, found }
    } else if forecast.has_goals() != first.has_goals() {
        WindowProblem::GoalsOfSome
    } else if forecast.certified(0, 0).is_some() != first.certified(0, 0).is_some() {
        WindowProblem::CertificatesOfSome
    } else {
        return Ok(());
    };
    Err(EvaluationError::in_window(window, problem))
}

struct SceneScores {
    pedestrians: Vec<PedestrianScores>,
    /// JADE and JFDE times the pedestrians, metres.
    joint: [f64; 2],
    futures: Option<SceneFutures>,
    rollouts: Vec<RolloutStability>,
}

impl SceneScores {
    fn of(scene: &ScoredWindow<'_>, protocol: Protocol) -> Self {
        let errors = DisplacementErrors::of(scene);
        let best = (protocol == Protocol::Joint).then(|| errors.best_futures());
        Self {
            pedestrians: PedestrianScores::of(scene, &errors, best),
            joint: errors.joint().map(|mean| mean * scene.pedestrians() as f64),
            futures: best.map(|[best, _]| SceneFutures::of(scene, best)),
            rollouts: stability::rollouts(scene),
        }
    }
}

#[cfg(test)]
mod tests;
