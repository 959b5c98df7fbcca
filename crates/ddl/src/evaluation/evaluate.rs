use crate::error::DdlError;
use crate::evaluation::manner::{GivenGoals, Manner, Way, memory_words};
use crate::evaluation::published::Published;
use crate::evaluation::rows::{Forecasted, ResultRows};
use crate::evaluation::split::Split;
use crate::evaluation::straight_lines::straight_lines;
use crate::evaluation::test_set::TestSet;
use crate::goals::model::GoalModel;
use crate::goals::remembering::Remembering;
use crate::goals::sets;
use crate::model::ddl::Ddl;
use crate::training::words;
use ddl_core::{Forecast, ForecastError, Forecaster as _};
use ddl_data::{Dataset, Window};
use ddl_eval::baseline::WeightedGoals;
use ddl_eval::{Protocol, ResultRow};
use ddl_goal::{GoalSet, QuerySpan};
use ddl_report::{ForecastSnapshot, gallery};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

const PEDESTRIANS_PER_REPORT: usize = 128;
/// Protocols that show only the windows.
const ALONE: [Protocol; 2] = [Protocol::Fair, Protocol::Single];
/// Protocols that also show the recording before the last observed frame of a window.
const WATCHING: [Protocol; 2] = [Protocol::Online, Protocol::OnlineSingle];
/// Largest number of test pedestrians on which the published protocol chooses its epoch.
const SELECTION_PEDESTRIANS: usize = 250;

/// What to evaluate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EvaluationRequest {
    /// The protocols.
    pub protocols: Vec<Protocol>,
    /// The windows.
    pub on: Split,
    /// Recordings that form the validation part of own recordings, instead of the default part. Only for models that
    /// were not trained on any of these recordings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub validation_recordings: Vec<String>,
    /// Evaluate a seeded part of the windows with at least this many test pedestrians; `None`: all.
    pub test_pedestrians: Option<usize>,
    /// Commit of the program, for the record.
    pub commit: String,
}

/// Progress of an evaluation, for its observer.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluationProgress {
    /// Pedestrians forecast so far, and in total.
    pub pedestrians: (usize, usize),
    /// The current protocol.
    pub protocol: Protocol,
}

/// The result of an evaluation.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Evaluation {
    /// The scores, each with its conditions.
    pub rows: Vec<ResultRow>,
    /// Windows for display with the model's `fair` forecasts, under the headline rule; empty without that protocol.
    pub moments: Vec<ForecastSnapshot>,
}

/// Evaluates the model and the baselines on the test windows of the model's fold.
///
/// # Errors
/// When the data has another convention than the training data and is not own recordings; when the model was trained on
/// the data; when forecasting or scoring fails. [`DdlError::Interrupted`] when the observer asks to stop.
pub fn evaluate(
    model: &Ddl,
    dataset: &Dataset,
    request: &EvaluationRequest,
    observe: impl FnMut(&EvaluationProgress) -> ControlFlow<()>,
) -> Result<Evaluation, DdlError> {
    let part = (request.on, request.validation_recordings.as_slice());
    let test = TestSet::of_run(model.goal_model(), dataset, part, request.test_pedestrians)?;
    let asked = |some: &[Protocol]| some.iter().any(|p| request.protocols.contains(p));
    let passes = [&[Protocol::Published][..], &ALONE, &WATCHING].map(asked);
    let total = test.pedestrians() * passes.iter().filter(|asked| **asked).count();
    if asked(&WATCHING) {
        model.goal_model().recalled_per_pedestrian()?;
    }
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
    let remembering = |what| model.goal_model().remembering(&test.windows, dataset, what);
    let windows = if model.goal_model().remembers_place(dataset)? && asked(&ALONE) {
        remembering(Remembering::Place)?
    } else {
        test.windows.clone()
    };
    let results = measuring.without_future(&ALONE, &windows)?;
    rows.extend(results.rows);
    if asked(&WATCHING) {
        let windows = remembering(Remembering::Online)?;
        rows.extend(measuring.without_future(&WATCHING, &windows)?.rows);
    }
    Ok(Evaluation {
        rows,
        moments: results.moments,
    })
}

/// The model's own goals for a manner; `None` for the published goals, which another estimator makes.
fn goals_for(
    given: GivenGoals,
    model: &GoalModel,
    windows: &[Window],
    own: &[Vec<GoalSet>],
) -> Result<Vec<Vec<GoalSet>>, ForecastError> {
    match given {
        GivenGoals::Own | GivenGoals::Published => Ok(own.to_vec()),
        GivenGoals::Central => Ok(sets::with_central_only(windows, own)),
        GivenGoals::WithoutLibrary => model.goals_without_library(windows),
        GivenGoals::WithoutMemory => {
            let nothing = |window: &Window| window.clone().with_remembered(|_| Vec::new());
            model.goals(&windows.iter().map(nothing).collect::<Vec<_>>())
        }
    }
}

/// Forecasts of the model, and straight lines to its goals; one of each for each window.
struct Forecasts {
    /// One list for each manner.
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
    /// Evaluates protocols that show the same input: they share one set of forecasts.
    fn without_future(&mut self, of: &[Protocol], windows: &[Window]) -> Result<Evaluation, DdlError> {
        let protocols: Vec<Protocol> = of.iter().copied().filter(|p| self.asked(*p)).collect();
        let Some(&first) = protocols.first() else {
            return Ok(Evaluation::default());
        };
        let model = self.model;
        let mut manners = Manner::all(model, &self.request.protocols);
        manners.retain(|manner| protocols.contains(&manner.protocol));
        let goal = "the estimated goals";
        // Straight lines lead to several goals.
        let lines_asked = protocols.iter().any(|p| p.hypotheses() > 1);
        // The estimator copies the expert library, so make it only when it is needed.
        let given = |manner: &Manner| manner.goals == GivenGoals::Published;
        let published = if manners.iter().any(given) {
            Some(model.goal_model().published_estimator(QuerySpan::Observed)?)
        } else {
            None
        };
        let forecasts = self.forecast((first, windows), manners.len(), |windows| {
            let goals = model.goal_model().goals(windows)?;
            let towards = |manner: &Manner| {
                let goals = match &published {
                    Some(estimator) if given(manner) => sets::retrieved(estimator, windows)?,
                    _ => goals_for(manner.goals, model.goal_model(), windows, &goals)?,
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
        for &protocol in &protocols {
            let admit = |forecasts: &[Forecast], name: &str| protocol.admit(forecasts.to_vec(), name);
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
            if protocol.hypotheses() > 1 {
                let lines = admit(&forecasts.lines, "straight line")?;
                let goals = model.goal_model().words() + &memory_words(protocol, model);
                let recipe = format!("goals {goals}");
                forecasted.push(Forecasted::lines_to(goal, recipe, lines));
            }
            let selection = words::selection(model.config().patience);
            rows.extend(self.rows(protocol, selection).of(&forecasted)?);
        }
        let moments = if protocols.contains(&Protocol::Fair) {
            self.moments(&forecasts.model[0])?
        } else {
            Vec::new()
        };
        Ok(Evaluation { rows, moments })
    }

    /// Windows for display, from the model's forecasts for each window of the test set.
    fn moments(&self, forecasts: &[Forecast]) -> Result<Vec<ForecastSnapshot>, DdlError> {
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
        let mut pedestrians = 0;
        let windows: Vec<Window> = self
            .test
            .headline()
            .take_while(|window| {
                let first = pedestrians == 0;
                pedestrians += window.len();
                first || pedestrians <= SELECTION_PEDESTRIANS
            })
            .cloned()
            .collect();
        let model = self.model;
        let tick = || self.report(0, protocol);
        let best = Published::best_on_test(model, &estimator, &windows, tick)?;
        let goal = "the estimated goal nearest the TRUE end";
        let test = self.test;
        let mut forecasts = self.forecast((protocol, &test.windows), 1, |windows| {
            let goals = sets::nearest_true_end(&estimator, windows)?;
            let certain: Vec<Vec<WeightedGoals>> = goals
                .iter()
                .map(|goals| goals.iter().map(|&goal| WeightedGoals::certain(goal)).collect())
                .collect();
            let lines = straight_lines(goal, windows, &certain)?;
            Ok(Forecasts {
                model: vec![best.forecast_towards(windows, &goals)?],
                lines,
            })
        })?;
        let words = model.goal_model().words();
        let selection = format!("best kept epoch on up to {SELECTION_PEDESTRIANS} TEST pedestrians");
        self.rows(protocol, &selection).of(&[
            Forecasted::model(&model.name(), forecasts.model.remove(0), None, words),
            Forecasted::lines_to(goal, "goals of the published estimator".to_owned(), forecasts.lines),
        ])
    }

    /// Forecasts all windows in several manners, in chunks. The model sees the futures only if the protocol shows them.
    fn forecast(
        &mut self,
        (protocol, windows): (Protocol, &[Window]),
        manners: usize,
        of: impl Fn(&[Window]) -> Result<Forecasts, ForecastError>,
    ) -> Result<Forecasts, DdlError> {
        let mut all = Forecasts {
            model: vec![Vec::new(); manners],
            lines: Vec::new(),
        };
        let mut done = 0;
        while done < windows.len() {
            let rest = &windows[done..];
            let mut pedestrians = 0;
            let count = rest
                .iter()
                .position(|window| {
                    pedestrians += window.len();
                    pedestrians >= PEDESTRIANS_PER_REPORT
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

    fn report(&mut self, pedestrians: usize, protocol: Protocol) -> Result<(), DdlError> {
        self.done += pedestrians;
        let progress = EvaluationProgress {
            pedestrians: (self.done, self.total),
            protocol,
        };
        match (self.observe)(&progress) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(DdlError::Interrupted),
        }
    }
}
