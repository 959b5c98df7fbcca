//! A model on the test windows of its fold, beside the baselines, under each protocol asked for.

use crate::DdlError;
use crate::goals;
use crate::model::Ddl;
use crate::published::Published;
use crate::straight_lines::straight_lines;
use crate::test_set::TestSet;
use crate::training_words::{recipe, subset};
use ddl_data::{Dataset, Window};
use ddl_eval::baseline::{self, WeightedGoals};
use ddl_eval::{Conditions, Forecast, ForecastError, Forecaster, Protocol, ResultRow, Scores};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Walkers forecast between two reports of progress.
const WALKERS_A_REPORT: usize = 128;
/// Walkers of the test set on which the published protocol chooses its epoch, at most.
const SELECTION_WALKERS: usize = 250;
/// Seed of constant velocity with angular noise: the same in every run, so that runs agree.
const NOISE_SEED: u64 = 1;

/// Which windows to measure on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EvaluationSplit {
    /// The scene left out of training.
    Test,
    /// The last part of the training recordings, kept out of training for choices to be made on.
    Validation,
}

/// What to measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EvaluationRequest {
    /// Under which protocols.
    pub protocols: Vec<Protocol>,
    /// On which windows.
    pub on: EvaluationSplit,
    /// On at least so many test walkers, a seeded part; on all when `None`.
    pub test_walkers: Option<usize>,
    /// Commit of the program, for the record.
    pub commit: String,
}

/// What the evaluation tells its observer.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluationProgress {
    /// Walkers forecast so far, and in all.
    pub walkers: (usize, usize),
    /// The protocol under way.
    pub protocol: Protocol,
}

/// Measures the model and the baselines on the test windows of the model's fold.
///
/// # Errors
/// When the data is not the convention the model was trained on, or forecasting or scoring fails;
/// [`DdlError::Interrupted`] when the observer asks to stop.
pub fn evaluate(
    model: &Ddl,
    dataset: &Dataset,
    request: &EvaluationRequest,
    observe: impl FnMut(&EvaluationProgress) -> ControlFlow<()>,
) -> Result<Vec<ResultRow>, DdlError> {
    let test = TestSet::of_run(
        model.goal_model(),
        dataset,
        request.on,
        request.test_walkers,
    )?;
    let passes = usize::from(request.protocols.contains(&Protocol::Published))
        + usize::from(
            request
                .protocols
                .iter()
                .any(|protocol| !protocol.shows_future()),
        );
    let total = test.walkers() * passes;
    let mut measuring = Measuring {
        model,
        test: &test,
        request,
        observe,
        done: 0,
        total,
    };
    let mut rows = Vec::new();
    if request.protocols.contains(&Protocol::Published) {
        rows.extend(measuring.published()?);
    }
    rows.extend(measuring.honest()?);
    Ok(rows)
}

/// Forecasts of the model and straight lines to the same goals, one each a window.
#[derive(Default)]
struct Forecasts {
    model: Vec<Forecast>,
    lines: Vec<Forecast>,
}

struct Measuring<'a, O> {
    model: &'a Ddl,
    test: &'a TestSet,
    request: &'a EvaluationRequest,
    observe: O,
    done: usize,
    total: usize,
}

impl<O: FnMut(&EvaluationProgress) -> ControlFlow<()>> Measuring<'_, O> {
    /// `fair` and `single`: one set of forecasts serves both.
    fn honest(&mut self) -> Result<Vec<ResultRow>, DdlError> {
        let protocols: Vec<Protocol> = Protocol::ALL
            .into_iter()
            .filter(|p| !p.shows_future() && self.asked(*p))
            .collect();
        let Some(&first) = protocols.first() else {
            return Ok(Vec::new());
        };
        let model = self.model;
        let forecasts = self.forecast(first, |windows| {
            let goals = model.goal_model().goals(windows)?;
            let lines = straight_lines("the estimated goals", windows, &goals::weighted(&goals)?)?;
            Ok(Forecasts {
                model: model.forecast_towards(windows, goals)?,
                lines,
            })
        })?;
        let mut rows = Vec::new();
        for protocol in protocols {
            let of_protocol = Forecasts {
                model: protocol.admit(forecasts.model.clone(), &model.name())?,
                lines: protocol.admit(forecasts.lines.clone(), "straight line")?,
            };
            rows.extend(self.rows(protocol, "last epoch", "the estimated goals", &of_protocol)?);
        }
        Ok(rows)
    }

    fn published(&mut self) -> Result<Vec<ResultRow>, DdlError> {
        let protocol = Protocol::Published;
        let estimator = self.model.goal_model().published_estimator()?;
        let mut walkers = 0;
        let windows: Vec<Window> = self
            .test
            .headline()
            .take_while(|window| {
                let first = walkers == 0;
                walkers += window.len();
                first || walkers <= SELECTION_WALKERS
            })
            .cloned()
            .collect();
        let model = self.model;
        let tick = || self.report(0, protocol);
        let best = Published::best_on_test(model, &estimator, &windows, tick)?;
        let goal = "the estimated goal nearest the TRUE end";
        let forecasts = self.forecast(protocol, |windows| {
            let goals = goals::nearest_true_end(&estimator, windows)?;
            let certain: Vec<Vec<WeightedGoals>> = goals
                .iter()
                .map(|goals| {
                    goals
                        .iter()
                        .map(|&goal| WeightedGoals::certain(goal))
                        .collect()
                })
                .collect();
            let lines = straight_lines(goal, windows, &certain)?;
            Ok(Forecasts {
                model: best.forecast_towards(windows, &goals)?,
                lines,
            })
        })?;
        let selection = format!("best kept epoch on up to {SELECTION_WALKERS} TEST walkers");
        self.rows(protocol, &selection, goal, &forecasts)
    }

    /// Forecasts all windows, some at a time, showing their futures only where the protocol does.
    fn forecast(
        &mut self,
        protocol: Protocol,
        of: impl Fn(&[Window]) -> Result<Forecasts, ForecastError>,
    ) -> Result<Forecasts, DdlError> {
        let mut all = Forecasts::default();
        while all.model.len() < self.test.windows.len() {
            let rest = &self.test.windows[all.model.len()..];
            let mut walkers = 0;
            let count = rest
                .iter()
                .position(|window| {
                    walkers += window.len();
                    walkers >= WALKERS_A_REPORT
                })
                .map_or(rest.len(), |last| last + 1);
            let some = of(&protocol.visible(&rest[..count]))?;
            all.model.extend(some.model);
            all.lines.extend(some.lines);
            self.report(rest[..count].iter().map(Window::len).sum(), protocol)?;
        }
        Ok(all)
    }

    /// Rows of the model, the straight lines and the baselines, under each window rule.
    fn rows(
        &self,
        protocol: Protocol,
        selection: &str,
        goal_name: &str,
        forecasts: &Forecasts,
    ) -> Result<Vec<ResultRow>, DdlError> {
        let config = self.model.config();
        let training = &config.training;
        let mut rows = Vec::new();
        for (rule, indices) in &self.test.rules {
            // a small part may hold no window of one of the rules
            if indices.is_empty() {
                continue;
            }
            let windows: Vec<Window> = indices
                .iter()
                .map(|&index| self.test.windows[index].clone())
                .collect();
            let plain = Conditions {
                device: "cpu".to_owned(),
                commit: self.request.commit.clone(),
                test_subset: self.test.subset.clone(),
                ..Conditions::new(
                    config.data.convention,
                    *rule,
                    protocol,
                    &*config.data.fold,
                    "",
                )
            };
            let of_model = Conditions {
                forecaster: self.model.name(),
                variant: Some(config.star.variant.name().to_owned()),
                seed: Some(training.seed),
                epochs: Some(training.epochs),
                selection: Some(selection.to_owned()),
                device: self.model.device().name().to_owned(),
                training_subset: subset(training),
                recipe: Some(recipe(training, &config.goals)),
                ..plain.clone()
            };
            let of_lines = Conditions {
                forecaster: format!("straight line to {goal_name}"),
                ..plain.clone()
            };
            for (conditions, all) in [(of_model, &forecasts.model), (of_lines, &forecasts.lines)] {
                let of_rule: Vec<Forecast> = indices.iter().map(|&i| all[i].clone()).collect();
                let scores = Scores::evaluate(&windows, &of_rule)?;
                rows.push(ResultRow { conditions, scores });
            }
            rows.extend(baseline::measure(&plain, &windows, NOISE_SEED)?);
        }
        Ok(rows)
    }

    fn asked(&self, protocol: Protocol) -> bool {
        self.request.protocols.contains(&protocol)
    }

    fn report(&mut self, walkers: usize, protocol: Protocol) -> Result<(), DdlError> {
        self.done += walkers;
        let progress = EvaluationProgress {
            walkers: (self.done, self.total),
            protocol,
        };
        match (self.observe)(&progress) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(DdlError::Interrupted),
        }
    }
}
