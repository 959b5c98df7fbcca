use crate::error::DdlError;
use crate::evaluation::manner::{GivenGoals, Manner, Way};
use crate::evaluation::published::Published;
use crate::evaluation::rows::{Forecasted, ResultRows};
use crate::evaluation::split::EvaluationSplit;
use crate::evaluation::straight_lines::straight_lines;
use crate::evaluation::test_set::TestSet;
use crate::goals::sets;
use crate::model::ddl::Ddl;
use crate::training::words;
use ddl_data::{Dataset, Window};
use ddl_eval::baseline::WeightedGoals;
use ddl_eval::{Forecast, ForecastError, Forecaster as _, Protocol, ResultRow};
use ddl_goal::QuerySpan;
use ddl_report::{Moment, gallery};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

const WALKERS_A_REPORT: usize = 128;
/// Walkers of the test set on which the published protocol chooses its epoch, at most.
const SELECTION_WALKERS: usize = 250;

/// What to measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EvaluationRequest {
    /// Under which protocols.
    pub protocols: Vec<Protocol>,
    /// On which windows.
    pub on: EvaluationSplit,
    /// Recordings that are the validation part of own recordings, instead of that which a training would keep; only for models that know none of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub validation_recordings: Vec<String>,
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

/// What an evaluation gives.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Evaluation {
    /// The numbers, each with its conditions.
    pub rows: Vec<ResultRow>,
    /// Moments to look at, with what the model forecast under `fair`, on windows of the headline rule; none without that protocol.
    pub moments: Vec<Moment>,
}

/// Measures the model and the baselines on the test windows of the model's fold.
///
/// # Errors
/// When the data is neither of the convention the model was trained on nor somebody's own, when the model has learned from it, or forecasting or scoring fails;
/// [`DdlError::Interrupted`] when the observer asks to stop.
pub fn evaluate(
    model: &Ddl,
    dataset: &Dataset,
    request: &EvaluationRequest,
    observe: impl FnMut(&EvaluationProgress) -> ControlFlow<()>,
) -> Result<Evaluation, DdlError> {
    let part = (request.on, request.validation_recordings.as_slice());
    let test = TestSet::of_run(model.goal_model(), dataset, part, request.test_walkers)?;
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
    let honest = measuring.honest()?;
    rows.extend(honest.rows);
    Ok(Evaluation {
        rows,
        moments: honest.moments,
    })
}

/// Forecasts of the model and straight lines to its own goals, one each a window.
struct Forecasts {
    /// One list a manner.
    model: Vec<Vec<Forecast>>,
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
    fn honest(&mut self) -> Result<Evaluation, DdlError> {
        let protocols: Vec<Protocol> = Protocol::ALL
            .into_iter()
            .filter(|p| !p.shows_future() && self.asked(*p))
            .collect();
        let Some(&first) = protocols.first() else {
            return Ok(Evaluation::default());
        };
        let model = self.model;
        let manners = Manner::all(model, &self.request.protocols);
        let goal = "the estimated goals";
        // Straight lines lead to many goals.
        let lines_asked = protocols.iter().any(|&p| p != Protocol::Single);
        // Its library is copied: only where it is asked for.
        let given = |manner: &Manner| manner.goals == GivenGoals::Published;
        let published = if manners.iter().any(given) {
            Some(
                model
                    .goal_model()
                    .published_estimator(QuerySpan::Observed)?,
            )
        } else {
            None
        };
        let forecasts = self.forecast(first, manners.len(), |windows| {
            let goals = model.goal_model().goals(windows)?;
            let towards = |manner: &Manner| {
                let goals = match (manner.goals, &published) {
                    (GivenGoals::Central, _) => sets::only_central(windows, &goals),
                    (GivenGoals::WithoutLibrary, _) => {
                        model.goal_model().goals_without_library(windows)?
                    }
                    (GivenGoals::Published, Some(estimator)) => {
                        sets::retrieved(estimator, windows)?
                    }
                    _ => goals.clone(),
                };
                match manner.way {
                    Way::Shaped(gait) => model.forecast_towards(windows, goals, gait),
                    Way::Neutral(clearance) => model.forecast_neutral(windows, goals, clearance),
                }
            };
            Ok(Forecasts {
                model: manners.iter().map(towards).collect::<Result<_, _>>()?,
                lines: if lines_asked {
                    straight_lines(goal, windows, &sets::weighted(&goals)?)?
                } else {
                    Vec::new()
                },
            })
        })?;
        let mut rows = Vec::new();
        for protocol in protocols {
            let admit =
                |forecasts: &[Forecast], name: &str| protocol.admit(forecasts.to_vec(), name);
            let mut forecasted = Vec::new();
            for (manner, forecasts) in manners.iter().zip(&forecasts.model) {
                if manner.protocol == protocol {
                    let admitted = admit(forecasts, &model.name())?;
                    forecasted.push(Forecasted::model(
                        &model.name(),
                        admitted,
                        manner.change.as_deref(),
                        manner.goal_words(model),
                    ));
                }
            }
            if protocol != Protocol::Single {
                let lines = admit(&forecasts.lines, "straight line")?;
                let recipe = format!("goals {}", model.goal_model().words());
                forecasted.push(Forecasted::lines_to(goal, recipe, lines));
            }
            let selection = words::selection(model.config().patience);
            rows.extend(self.rows(protocol, selection).of(&forecasted)?);
        }
        let moments = if self.asked(Protocol::Fair) {
            self.moments(&forecasts.model[0])?
        } else {
            Vec::new()
        };
        Ok(Evaluation { rows, moments })
    }

    /// What to look at of the model's forecasts, one a window of the test set.
    fn moments(&self, forecasts: &[Forecast]) -> Result<Vec<Moment>, DdlError> {
        let (windows, forecasts): (Vec<Window>, Vec<Forecast>) = self
            .test
            .headline_indices()
            .map(|index| (self.test.windows[index].clone(), forecasts[index].clone()))
            .unzip();
        Ok(gallery::moments(
            &self.test.fold,
            &self.model.name(),
            &windows,
            &forecasts,
        )?)
    }

    fn published(&mut self) -> Result<Vec<ResultRow>, DdlError> {
        let protocol = Protocol::Published;
        let goal_model = self.model.goal_model();
        let estimator = goal_model.published_estimator(QuerySpan::PublishedFuture)?;
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
        let mut forecasts = self.forecast(protocol, 1, |windows| {
            let goals = sets::nearest_true_end(&estimator, windows)?;
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
                model: vec![best.forecast_towards(windows, &goals)?],
                lines,
            })
        })?;
        let words = model.goal_model().words();
        let selection = format!("best kept epoch on up to {SELECTION_WALKERS} TEST walkers");
        self.rows(protocol, &selection).of(&[
            Forecasted::model(&model.name(), forecasts.model.remove(0), None, words),
            Forecasted::lines_to(
                goal,
                "goals of the published estimator".to_owned(),
                forecasts.lines,
            ),
        ])
    }

    /// Forecasts all windows in a number of manners, some windows at a time, showing their futures only where
    /// the protocol does.
    fn forecast(
        &mut self,
        protocol: Protocol,
        manners: usize,
        of: impl Fn(&[Window]) -> Result<Forecasts, ForecastError>,
    ) -> Result<Forecasts, DdlError> {
        let mut all = Forecasts {
            model: vec![Vec::new(); manners],
            lines: Vec::new(),
        };
        let mut done = 0;
        while done < self.test.windows.len() {
            let rest = &self.test.windows[done..];
            let mut walkers = 0;
            let count = rest
                .iter()
                .position(|window| {
                    walkers += window.len();
                    walkers >= WALKERS_A_REPORT
                })
                .map_or(rest.len(), |last| last + 1);
            let some = of(&protocol.visible(&rest[..count]))?;
            for (all, some) in all.model.iter_mut().zip(some.model) {
                all.extend(some);
            }
            all.lines.extend(some.lines);
            done += count;
            self.report(rest[..count].iter().map(Window::len).sum(), protocol)?;
        }
        Ok(all)
    }

    fn rows<'b>(&'b self, protocol: Protocol, selection: &'b str) -> ResultRows<'b> {
        ResultRows {
            model: self.model,
            test: self.test,
            protocol,
            selection,
            commit: &self.request.commit,
        }
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
