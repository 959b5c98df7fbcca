//! All metrics of a test set in one value.

use ddl_data::Window;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::{
    Forecast, Scene,
    error::EvaluationError,
    metric::{
        collision::{self, DISC_RADIUS},
        displacement::DisplacementErrors,
        goal::goal_fde,
        joint::{joint_ade, joint_fde},
        miss::{MISS_DISTANCE, is_miss},
        stability::{self, RolloutStability, StabilityScores},
    },
};

/// The metrics of one forecaster on the test windows of one fold.
///
/// Means are over pedestrians; a pedestrian in several windows counts once for each. The mean over
/// the five folds is the plain mean of their `Scores` (see [`Report`](crate::Report)).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scores {
    /// Pedestrians scored, over all windows.
    pub pedestrians: usize,
    /// Windows scored.
    pub windows: usize,
    /// Hypotheses a pedestrian, K.
    pub hypotheses: usize,
    /// minADE over K, metres.
    pub min_ade: f64,
    /// minFDE over K, a minimum of its own, metres.
    pub min_fde: f64,
    /// FDE of the hypothesis of least ADE, metres.
    pub fde_at_min_ade: f64,
    /// JADE: one hypothesis index for the whole scene, metres.
    pub joint_ade: f64,
    /// JFDE, metres.
    pub joint_fde: f64,
    /// Share of pedestrians whom every hypothesis misses by more than 0.5 m at the end, in [0, 1].
    pub miss_rate: f64,
    /// Share of pedestrians whose most likely forecast collides with another's, in [0, 1].
    pub collision_rate: f64,
    /// The same share of the true futures, in [0, 1].
    pub true_collision_rate: f64,
    /// Distance of the nearest goal from the true end, metres; `None` for forecasts without goals.
    pub goal_fde: Option<f64>,
    /// Behaviour of the rollouts towards their goals; `None` for forecasts without goals.
    pub stability: Option<StabilityScores>,
}

impl Scores {
    /// Scores one forecast a window, all windows together.
    ///
    /// Windows are measured in parallel and summed in order: the result does not depend on the number
    /// of threads.
    ///
    /// # Errors
    /// There is no window, a window has no future, a forecast does not belong to its window, or the
    /// forecasts differ in their number of hypotheses, in having goals or in having certificates.
    pub fn evaluate(windows: &[Window], forecasts: &[Forecast]) -> Result<Self, EvaluationError> {
        if windows.len() != forecasts.len() {
            let (windows, forecasts) = (windows.len(), forecasts.len());
            return Err(EvaluationError::Count { windows, forecasts });
        }
        let first = forecasts.first().ok_or(EvaluationError::NoWindows)?;
        let sums: Vec<SceneSums> = windows
            .par_iter()
            .zip(forecasts)
            .map(|(window, forecast)| {
                check_alike(window, forecast, first)?;
                Ok(SceneSums::of(&Scene::new(window, forecast)?))
            })
            .collect::<Result<_, EvaluationError>>()?;
        Ok(Self::from_sums(&sums, first))
    }

    fn from_sums(sums: &[SceneSums], first: &Forecast) -> Self {
        let pedestrians: usize = sums.iter().map(|s| s.pedestrians).sum();
        let mean =
            |of: fn(&SceneSums) -> f64| sums.iter().map(of).sum::<f64>() / pedestrians as f64;
        let rollouts: Vec<RolloutStability> = sums
            .iter()
            .flat_map(|s| s.rollouts.iter().copied())
            .collect();
        Self {
            pedestrians,
            windows: sums.len(),
            hypotheses: first.hypotheses(),
            min_ade: mean(|s| s.min_ade),
            min_fde: mean(|s| s.min_fde),
            fde_at_min_ade: mean(|s| s.fde_at_min_ade),
            joint_ade: mean(|s| s.joint_ade),
            joint_fde: mean(|s| s.joint_fde),
            miss_rate: mean(|s| s.misses as f64),
            collision_rate: mean(|s| s.collisions as f64),
            true_collision_rate: mean(|s| s.true_collisions as f64),
            goal_fde: first.has_goals().then(|| mean(|s| s.goal_fde)),
            stability: StabilityScores::mean(&rollouts),
        }
    }
}

fn check_alike(
    window: &Window,
    forecast: &Forecast,
    first: &Forecast,
) -> Result<(), EvaluationError> {
    let (recording, start_frame) = (window.recording().to_owned(), window.start_frame());
    if forecast.hypotheses() != first.hypotheses() {
        return Err(EvaluationError::Hypotheses {
            recording,
            start_frame,
            expected: first.hypotheses(),
            found: forecast.hypotheses(),
        });
    }
    if forecast.has_goals() != first.has_goals() {
        return Err(EvaluationError::GoalsOfSome {
            recording,
            start_frame,
        });
    }
    if forecast.has_certificates() != first.has_certificates() {
        return Err(EvaluationError::CertificatesOfSome {
            recording,
            start_frame,
        });
    }
    Ok(())
}

/// Sums over the pedestrians of one window.
struct SceneSums {
    pedestrians: usize,
    min_ade: f64,
    min_fde: f64,
    fde_at_min_ade: f64,
    joint_ade: f64,
    joint_fde: f64,
    misses: usize,
    collisions: usize,
    true_collisions: usize,
    goal_fde: f64,
    rollouts: Vec<RolloutStability>,
}

impl SceneSums {
    fn of(scene: &Scene<'_>) -> Self {
        let errors = DisplacementErrors::of(scene);
        let n = scene.pedestrians();
        let sum = |of: fn(&DisplacementErrors, usize) -> f64| (0..n).map(|i| of(&errors, i)).sum();
        Self {
            pedestrians: n,
            min_ade: sum(DisplacementErrors::min_ade),
            min_fde: sum(DisplacementErrors::min_fde),
            fde_at_min_ade: sum(DisplacementErrors::fde_at_min_ade),
            joint_ade: joint_ade(&errors) * n as f64,
            joint_fde: joint_fde(&errors) * n as f64,
            misses: (0..n)
                .filter(|&i| is_miss(&errors, i, MISS_DISTANCE))
                .count(),
            collisions: collision::forecast_collisions(scene, DISC_RADIUS),
            true_collisions: collision::true_collisions(scene, DISC_RADIUS),
            goal_fde: (0..n).filter_map(|i| goal_fde(scene, i)).sum(),
            rollouts: stability::rollouts(scene),
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::metric::fixture::{forecast, walk, window};

    /// One window of one pedestrian (errors 1 m) and one of three (errors 0): the mean is over the
    /// four pedestrians, not over the two windows.
    #[test]
    fn means_are_over_pedestrians() {
        let (still, far) = ([0.0, 0.0], [[0.0, 0.0], [5.0, 0.0], [9.0, 0.0]]);
        let windows = [window(&[still], &[still]), window(&far, &[still; 3])];
        let forecasts = [
            forecast(1, &[walk([1.0, 0.0], still)]),
            forecast(3, &far.map(|at| walk(at, still))),
        ];
        let scores = Scores::evaluate(&windows, &forecasts).unwrap();
        assert_eq!(
            (scores.pedestrians, scores.windows, scores.hypotheses),
            (4, 2, 1)
        );
        for mean in [
            scores.min_ade,
            scores.min_fde,
            scores.fde_at_min_ade,
            scores.joint_ade,
        ] {
            assert_relative_eq!(mean, 0.25);
        }
        assert_relative_eq!(scores.miss_rate, 0.25);
        assert_eq!((scores.goal_fde, scores.stability), (None, None));
    }

    #[test]
    fn what_does_not_belong_together_is_refused() {
        let still = [0.0, 0.0];
        let windows = [window(&[still], &[still]), window(&[still], &[still])];
        let one = forecast(1, &[walk(still, still)]);
        let two = forecast(1, &[walk(still, still), walk(still, still)]);
        let pair = forecast(2, &[walk(still, still), walk(still, still)]);
        let error = |w: &[Window], f: &[Forecast]| Scores::evaluate(w, f).unwrap_err();
        assert_eq!(error(&[], &[]), EvaluationError::NoWindows);
        assert!(matches!(
            error(&windows, &[]),
            EvaluationError::Count {
                windows: 2,
                forecasts: 0
            }
        ));
        assert!(matches!(
            error(&windows, &[one.clone(), two]),
            EvaluationError::Hypotheses {
                expected: 1,
                found: 2,
                ..
            }
        ));
        assert!(matches!(
            error(&windows[..1], &[pair]),
            EvaluationError::Pedestrians {
                expected: 1,
                found: 2,
                ..
            }
        ));
        assert!(matches!(
            error(&[windows[0].without_future()], &[one]),
            EvaluationError::NoFuture { .. }
        ));
    }
}
