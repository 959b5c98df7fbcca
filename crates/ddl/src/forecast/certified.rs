//! Walks to the goals, and their certificates.

use crate::forecast::answer::Certificates;
use crate::forecast::name::NAME;
use crate::forecast::walk::GoalApproach;
use crate::trust::calibration::Calibration;
use ddl_core::{Forecast, ForecastError, HORIZON, OBSERVED, Pace, PedestrianName, Position, Spread, Window};
use ddl_dynamics::{DynamicsError, LyapunovCertificate, MotionBounds};
use ddl_network::{NetworkFrame, StarConfig, StepRule, Variant, motion_bounds};
use rayon::prelude::*;

/// The reason why a forecast has no certificates.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum CertificateError {
    #[error(
        "the variant `{variant}` has no flow to certify: its network emits positions; use a model of the \
         variant `full` or `no-goal-shift`, or forecast without certificates"
    )]
    NoFlow { variant: Variant },
    #[error("whoever follows a plan has no flow to certify: leave out the plan or the certificates")]
    GivenPlan,
    #[error(
        "window of `{recording}` starting at frame {start_frame}, pedestrian {pedestrian}, hypothesis \
         {hypothesis}: {cause}; check that the positions are in metres and that training has not diverged"
    )]
    Walk { recording: String, start_frame: i64, pedestrian: PedestrianName, hypothesis: usize, cause: DynamicsError },
}

/// Goals, weights and steps for the pedestrians of a window.
#[derive(Debug)]
pub(crate) struct Walked<'a> {
    pub(crate) config: &'a StarConfig,
    pub(crate) rule: StepRule,
    pub(crate) window: &'a Window,
    pub(crate) hypotheses: usize,
    /// `[N][K][12]`: the path of the network's own rollout, metres; empty if the network is not used.
    pub(crate) rolled_out: Vec<Position>,
    /// `[N][K][12]`: (a, b, c) of the factor of P; `None` without a flow.
    pub(crate) factors: Option<Vec<[f64; 3]>>,
    /// N: share of the network's metric in the metric of the steps.
    pub(crate) shares: Vec<f64>,
    /// N: familiarity of the observed motions; `None` if it is not requested.
    pub(crate) familiarity: Option<Vec<f64>>,
    /// `None`: that of the calibration.
    pub(crate) spread: Option<Spread>,
    /// `[N][K]`: start and bounds of a path that begins elsewhere than the window ends; or empty.
    pub(crate) origins: Vec<Option<(Position, MotionBounds<f64>)>>,
    pub(crate) weights: Vec<f64>,
    pub(crate) goals: Vec<Position>,
}

impl Walked<'_> {
    /// The forecast. If there is a flow, it states which certificates hold.
    pub(crate) fn forecast(mut self) -> Result<Forecast, ForecastError> {
        let rolled_out = std::mem::take(&mut self.rolled_out);
        if self.factors.is_none() {
            return self.at(rolled_out);
        }
        // Certificates of a crowd take more memory than its forecast: drop each after its check.
        let (positions, held) = self.walks(rolled_out, |certificate| certificate.verify().is_ok())?;
        Ok(self.at(positions)?.with_certified(held)?)
    }

    /// The forecast of these positions, with its spread if there are several hypotheses.
    pub(crate) fn at(&self, positions: Vec<Position>) -> Result<Forecast, ForecastError> {
        let (pedestrians, hypotheses) = (self.window.len(), self.hypotheses);
        let (weights, goals) = (self.weights.clone(), Some(self.goals.clone()));
        let forecast = Forecast::new(pedestrians, hypotheses, positions, weights, goals)?;
        let Some(familiarity) = &self.familiarity else {
            return Ok(forecast);
        };
        let forecast = forecast.with_familiarity(familiarity.clone())?;
        match self.spread.clone().or_else(|| self.calibrated()) {
            Some(spread) => Ok(forecast.with_spread(spread)?),
            None => Ok(forecast),
        }
    }

    /// The spread that is calibrated; `None` for one hypothesis.
    pub(crate) fn calibrated(&self) -> Option<Spread> {
        if self.hypotheses == 1 {
            return None;
        }
        let calibration = Calibration::fitted();
        let time_step = self.config.time_step;
        let pace = |i: usize| Pace::of(self.window.observed(i), time_step, self.window.quality(i).uncertainty());
        let paces: Vec<Pace> = (0..self.window.len()).map(pace).collect();
        let goals = self.goals.par_chunks_exact(self.hypotheses);
        let pairs = goals.zip(self.weights.par_chunks_exact(self.hypotheses)).enumerate();
        let scales = pairs
            .flat_map_iter(|(i, (goals, weights))| {
                let spread = calibration.spread(paces[i], self.window.observed(i), goals, weights, time_step);
                let quality = self.window.quality(i);
                // The goals of the hardly observed differ as their velocities may.
                let seconds = if quality.is_hardly_observed() { 0.0 } else { time_step };
                (1..).zip(spread).map(move |(t, spread)| spread.hypot(quality.deviation_after(f64::from(t) * seconds)))
            })
            .collect();
        Some(Spread { scales, paces, regions: Calibration::shared_regions() })
    }

    /// The forecast, and its certificates if they are asked for.
    pub(crate) fn certified(mut self, certificates: bool) -> Result<(Forecast, Certificates), ForecastError> {
        if !certificates {
            return Ok((self.forecast()?, Vec::new()));
        }
        let rolled_out = std::mem::take(&mut self.rolled_out);
        let (positions, certificates) = self.walks(rolled_out, |certificate| certificate)?;
        let held = certificates.iter().map(|certificate| certificate.verify().is_ok()).collect();
        Ok((self.at(positions)?.with_certified(held)?, certificates))
    }

    /// The positions of every hypothesis, `[N][K][12]`, and the result of `keep` for its certificate, `[N][K]`. With
    /// plain Euler steps the positions are those of the network's own rollout.
    pub(crate) fn walks<R: Send>(
        &self,
        rolled_out: Vec<Position>,
        keep: impl Fn(LyapunovCertificate<f64>) -> R + Sync,
    ) -> Result<(Vec<Position>, Vec<R>), ForecastError> {
        let Some(factors) = &self.factors else {
            return Err(no_flow(self.config.variant));
        };
        let mut positions = rolled_out;
        if let StepRule::Bounded = self.rule {
            // Another path replaces each.
            positions.resize(factors.len(), [0.0; 2]);
        }
        assert_eq!(positions.len(), factors.len(), "a position for each factor");
        let certificates = match self.rule {
            StepRule::Euler => self
                .each(factors, &mut positions, |approach, factors, path| approach.certify(path, factors).map(&keep))?,
            StepRule::Bounded => self.each(factors, &mut positions, |approach, factors, path| {
                let walk = approach.walk(factors)?;
                path.copy_from_slice(&walk.positions);
                Ok(keep(walk.certificate))
            })?,
        };
        Ok((positions, certificates))
    }

    /// Where its paths start, unless they have another origin (m).
    pub(crate) fn start(&self, i: usize) -> Position {
        self.window.observed(i)[OBSERVED - 1]
    }

    pub(crate) fn bounds(&self, i: usize) -> MotionBounds<f64> {
        let observed = self.window.observed(i);
        let bounds = motion_bounds(observed, self.config.time_step, self.shares[i]);
        match self.config.frame {
            NetworkFrame::World => bounds.absolute(),
            NetworkFrame::Goal => bounds,
        }
    }

    /// Applies `integrate` to every hypothesis, in order. Its arguments are the approach, the factors and the place of
    /// the path. The error is that of the first hypothesis that fails.
    fn each<R: Send>(
        &self,
        factors: &[[f64; 3]],
        positions: &mut [Position],
        integrate: impl Fn(&GoalApproach, &[[f64; 3]], &mut [Position]) -> Result<R, DynamicsError> + Sync,
    ) -> Result<Vec<R>, ForecastError> {
        let bounds: Vec<_> = (0..self.window.len()).map(|i| self.bounds(i)).collect();
        let pairs = factors.par_chunks_exact(HORIZON).enumerate().zip(positions.par_chunks_exact_mut(HORIZON));
        let results = pairs.map(|((pair, factors), path)| {
            let (i, hypothesis) = (pair / self.hypotheses, pair % self.hypotheses);
            let origin = self.origins.get(pair).copied().flatten();
            let (start, bounds) = origin.unwrap_or_else(|| (self.start(i), bounds[i]));
            let approach = GoalApproach {
                start,
                goal: self.goals[pair],
                sigma: self.config.sigma,
                time_step: self.config.time_step,
                bounds,
            };
            integrate(&approach, factors, path).map_err(|cause| {
                failed(CertificateError::Walk {
                    recording: self.window.recording().to_owned(),
                    start_frame: self.window.start_frame(),
                    pedestrian: self.window.name(i),
                    hypothesis,
                    cause,
                })
            })
        });
        // A parallel collect into a `Result` could return the error of any hypothesis.
        results.collect::<Vec<_>>().into_iter().collect()
    }
}

pub(crate) fn no_flow(variant: Variant) -> ForecastError {
    failed(CertificateError::NoFlow { variant })
}

pub(crate) fn failed(error: CertificateError) -> ForecastError {
    ForecastError::model(NAME, error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forecast::answer::Answer;
    use ddl_core::{ObservationQuality, PedestrianId, distance};

    /// Two pedestrians, the second badly observed, with two goals each; no part of the network is used.
    #[test]
    fn each_path_and_certificate_and_spread_is_of_its_own_pair() {
        let track = |x: f64, y: f64, step: f64| (0..8).map(|t| [x, y + step * f64::from(t)]).collect();
        let ids = vec![PedestrianId(4), PedestrianId(2)];
        let window = Window::new("yard", 30, 6, ids, vec![track(0.0, 1.0, 0.4), track(9.0, 5.0, -0.3)]).unwrap();
        let uncertain = ObservationQuality { deviation: 0.3, velocity_deviation: 0.2, ..ObservationQuality::default() };
        let window = window.with_qualities(vec![ObservationQuality::default(), uncertain]);
        let config = StarConfig::published(Variant::Full);
        let goals = vec![[0.5, 8.0], [-2.0, 7.0], [9.0, -1.0], [7.0, 0.0]];
        let away: Vec<Position> = (1..=HORIZON).map(|t| [9.0, 2.9 + 0.3 * t as f64]).collect();
        let walked = |rule: StepRule, rolled_out: Vec<Position>| Walked {
            config: &config,
            rule,
            window: &window,
            hypotheses: 2,
            rolled_out,
            factors: Some(vec![[1.0, 0.0, 1.0]; 4 * HORIZON]),
            shares: vec![0.0; 2],
            familiarity: Some(vec![0.5, 0.25]),
            spread: None,
            origins: Vec::new(),
            weights: vec![0.75, 0.25, 0.4, 0.6],
            goals: goals.clone(),
        };
        let answer = |walked: Walked<'_>| Answer::of_each(walked.certified(true).unwrap());
        let made = answer(walked(StepRule::Bounded, Vec::new()));
        assert_eq!(made.first_violation(), None);
        assert_eq!(*made.forecast(), walked(StepRule::Bounded, Vec::new()).forecast().unwrap());
        let (calibration, time_step) = (Calibration::fitted(), config.time_step);
        for (i, weights, deviation) in [(0, [0.75, 0.25], [0.0, 0.0]), (1, [0.4, 0.6], [0.3, 0.2 * 0.4])] {
            let (observed, goals) = (window.observed(i), &goals[2 * i..2 * i + 2]);
            let spread = calibration.spread(Pace::Walking, observed, goals, &weights, time_step);
            for (t, spread) in spread.into_iter().enumerate() {
                let added = f64::hypot(deviation[0], deviation[1] * (t + 1) as f64);
                assert!((made.forecast().scale(i, t).unwrap() - spread.hypot(added)).abs() < 1e-12);
            }
            // Each goes on from the last position, and arrives at its goal.
            for (k, goal) in goals.iter().enumerate() {
                let path = made.forecast().hypothesis(i, k);
                let off = [distance(path[0], observed[7]), distance(path[HORIZON - 1], *goal)];
                assert!(off[0] < 0.9 && off[1] < 0.05, "{i} {k}: {off:?}");
            }
        }
        // With plain steps the paths are those of the network: one of them leads away from its goal.
        let mut paths = [0, 1, 2, 3].map(|k| made.forecast().hypothesis(k / 2, k % 2));
        paths[2] = &away;
        let led_away = answer(walked(StepRule::Euler, paths.concat()));
        assert_eq!(led_away.forecast().hypothesis(1, 0), away);
        assert_eq!(led_away.forecast().certified(1, 0), Some(false));
        assert!(
            led_away.certificate(1, 0).unwrap().verify().is_err()
                && led_away.certificate(0, 1).unwrap().verify().is_ok()
        );
        let violated = led_away.first_violation().map(|(i, k, _)| (i, k));
        assert_eq!(violated, Some((1, 0)));
    }
}
