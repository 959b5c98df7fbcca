//! A model on the test windows of its fold, beside the baselines, under each protocol asked for.

use crate::DdlError;
use crate::goals::{EstimatedGoals, OracleGoals};
use crate::model::Ddl;
use crate::published::Published;
use crate::test_set::TestSet;
use ddl_data::{Dataset, Window};
use ddl_eval::baseline::{self, GoalSource, StraightLine};
use ddl_eval::{Conditions, Forecast, Forecaster, Protocol, ResultRow, Scores};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Walkers forecast between two reports of progress.
const WALKERS_A_REPORT: usize = 128;
/// Walkers of the test set on which the published protocol chooses its epoch, at most.
const SELECTION_WALKERS: usize = 250;

/// What to measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EvaluationRequest {
    /// Under which protocols.
    pub protocols: Vec<Protocol>,
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
    let data = &model.config().data;
    if data.convention != dataset.convention() {
        let problem = format!(
            "was trained on `{}` data and cannot be measured on `{}` data",
            data.convention,
            dataset.convention()
        );
        return Err(DdlError::run(model.run().path(), problem));
    }
    let fold = dataset.fold(&data.fold)?;
    let test = TestSet::new(&fold, data.convention, request.test_walkers);
    let total = test.walkers() * request.protocols.len();
    let mut measuring = Measuring {
        model,
        test: &test,
        request,
        observe,
        done: 0,
        total,
    };
    let mut rows = Vec::new();
    for &protocol in &request.protocols {
        rows.extend(measuring.protocol(protocol)?);
    }
    Ok(rows)
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
    fn protocol(&mut self, protocol: Protocol) -> Result<Vec<ResultRow>, DdlError> {
        match protocol {
            Protocol::Published => self.published(),
            Protocol::Fair | Protocol::Single => {
                let selection = Some("last epoch".to_owned());
                let mut rows = self.model_rows(protocol, selection, self.model)?;
                rows.extend(self.baselines(protocol, &EstimatedGoals(self.model.estimator()))?);
                Ok(rows)
            }
        }
    }

    fn published(&mut self) -> Result<Vec<ResultRow>, DdlError> {
        let protocol = Protocol::Published;
        let estimator = self.model.published_estimator()?;
        let mut walkers = 0;
        let windows: Vec<Window> = self
            .test
            .headline()
            .take_while(|window| {
                walkers += window.len();
                walkers <= SELECTION_WALKERS
            })
            .cloned()
            .collect();
        let model = self.model;
        let tick = || self.report(0, protocol);
        let forecaster = Published::best_on_test(model, &estimator, &windows, tick)?;
        let selection = format!("best kept epoch on up to {SELECTION_WALKERS} TEST walkers");
        let mut rows = self.model_rows(protocol, Some(selection), &forecaster)?;
        rows.extend(self.baselines(protocol, &OracleGoals(&estimator))?);
        Ok(rows)
    }

    /// One row a window rule; every window is forecast once.
    fn model_rows(
        &mut self,
        protocol: Protocol,
        selection: Option<String>,
        forecaster: &impl Forecaster,
    ) -> Result<Vec<ResultRow>, DdlError> {
        let mut forecasts: Vec<Forecast> = Vec::with_capacity(self.test.windows.len());
        while forecasts.len() < self.test.windows.len() {
            let rest = &self.test.windows[forecasts.len()..];
            let mut walkers = 0;
            let count = rest
                .iter()
                .position(|window| {
                    walkers += window.len();
                    walkers >= WALKERS_A_REPORT
                })
                .map_or(rest.len(), |last| last + 1);
            forecasts.extend(protocol.forecast(forecaster, &rest[..count])?);
            self.report(rest[..count].iter().map(Window::len).sum(), protocol)?;
        }
        let config = self.model.config();
        let training = &config.training;
        let conditions = Conditions {
            variant: Some(config.star.variant.name().to_owned()),
            seed: Some(training.seed),
            epochs: Some(training.epochs),
            selection,
            device: self.model.device().name().to_owned(),
            training_subset: training.walkers_per_epoch.map(|walkers| {
                format!("about {walkers} walkers an epoch, going round a seeded order of all")
            }),
            ..self.conditions(protocol, &forecaster.name())
        };
        self.score(&conditions, &forecasts)
    }

    fn baselines(
        &self,
        protocol: Protocol,
        goals: &impl GoalSource,
    ) -> Result<Vec<ResultRow>, DdlError> {
        let line = StraightLine::to(goals);
        let forecasts = protocol.forecast(&line, &self.test.windows)?;
        let mut rows = self.score(&self.conditions(protocol, &line.name()), &forecasts)?;
        for (rule, indices) in &self.test.rules {
            let windows: Vec<Window> = indices
                .iter()
                .map(|&index| self.test.windows[index].clone())
                .collect();
            let conditions = Conditions {
                window_rule: *rule,
                ..self.conditions(protocol, "baseline")
            };
            rows.extend(baseline::measure(&conditions, &windows, NOISE_SEED)?);
        }
        Ok(rows)
    }

    fn score(
        &self,
        conditions: &Conditions,
        forecasts: &[Forecast],
    ) -> Result<Vec<ResultRow>, DdlError> {
        let mut rows = Vec::new();
        for (rule, indices) in &self.test.rules {
            let windows: Vec<Window> = indices
                .iter()
                .map(|&index| self.test.windows[index].clone())
                .collect();
            let of_rule: Vec<Forecast> = indices
                .iter()
                .map(|&index| forecasts[index].clone())
                .collect();
            let scores = Scores::evaluate(&windows, &of_rule)?;
            rows.push(ResultRow {
                conditions: Conditions {
                    window_rule: *rule,
                    ..conditions.clone()
                },
                scores,
            });
        }
        Ok(rows)
    }

    fn conditions(&self, protocol: Protocol, forecaster: &str) -> Conditions {
        let data = &self.model.config().data;
        // every row is renamed to its own rule when it is scored
        let rule = self.test.rules[0].0;
        Conditions {
            device: "cpu".to_owned(),
            commit: self.request.commit.clone(),
            test_subset: self.test.subset.clone(),
            ..Conditions::new(
                data.convention,
                rule,
                protocol,
                data.fold.clone(),
                forecaster,
            )
        }
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

/// Seed of constant velocity with angular noise: the same in every run, so that runs agree.
const NOISE_SEED: u64 = 1;
