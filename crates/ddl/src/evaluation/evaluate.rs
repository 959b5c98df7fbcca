//! Evaluation of a model and the baselines on the windows of a test set.

use crate::error::DdlError;
use crate::evaluation::parts::{parts, pedestrians, scored};
use crate::evaluation::published::{self, OracleVariant, Published};
use crate::evaluation::rows::{NamedForecasts, ResultRows};
use crate::evaluation::straight_lines::{straight_lines, weighted};
use crate::evaluation::variant::{EvaluationVariant, GivenGoals, VariantMotion, memory_words};
use crate::forecast::answer::Answer;
use crate::forecast::request::Request;
use crate::goals::model::GoalModel;
use crate::goals::remembering::Remembering;
use crate::goals::sets;
use crate::model::ddl::Ddl;
use crate::run::words;
use crate::windows::test_set::{Split, TestSet};
use ddl_core::{Forecast, ForecastError, Forecaster as _, Position, WeightedGoals, Window, WorkDone};
use ddl_data::Dataset;
use ddl_eval::{Protocol, ResultRow};
use ddl_goal::{GoalSet, QuerySpan};
use ddl_network::Noise;
use ddl_report::{ForecastSnapshot, gallery};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Protocols that show only the windows.
const ALONE: [Protocol; 3] = [Protocol::Fair, Protocol::Single, Protocol::Joint];
/// Protocols that also show the recording before the last observed frame of a window.
const WATCHING: [Protocol; 2] = [Protocol::Online, Protocol::OnlineSingle];
/// The goals of the straight lines, without the protocol `published`.
const ESTIMATED_GOALS: &str = "the estimated goals";

/// What to evaluate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
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
    /// Observe the pedestrians only for the last so many rows, 1 to 8, at steps of 0.4 s; `None`: all that there are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub observed_rows: Option<usize>,
    /// Commit of the program, for the record.
    pub commit: String,
}

impl EvaluationRequest {
    /// All windows of the test scene, under these protocols.
    #[must_use]
    pub fn new(protocols: Vec<Protocol>) -> Self {
        Self {
            protocols,
            on: Split::Test,
            validation_recordings: Vec::new(),
            test_pedestrians: None,
            observed_rows: None,
            commit: "unknown".to_owned(),
        }
    }
}

/// Progress of an evaluation, for its observer.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluationProgress {
    /// Pedestrians forecast so far, and in total. Under `published`, the epochs that are compared count too.
    pub pedestrians: WorkDone,
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
    /// Windows of the widest rule with the model's futures of their scenes; empty without the protocol `joint`.
    pub scenes: Vec<(Window, Forecast)>,
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
    let test = TestSet::of_run(
        model.goal_model(),
        dataset,
        request.on,
        &request.validation_recordings,
        request.test_pedestrians,
    )?
    .observed_for(request.observed_rows);
    let asked = |some: &[Protocol]| some.iter().any(|p| request.protocols.contains(p));
    let passes = [&[Protocol::Published][..], &ALONE, &WATCHING].map(asked);
    let mut total = test.pedestrians() * passes.iter().filter(|asked| **asked).count();
    if let (true, Some(run)) = (asked(&[Protocol::Published]), model.run()) {
        total += published::compared_epochs(run)?.len() * test.headline().map(Window::len).sum::<usize>();
    }
    if asked(&WATCHING) {
        model.goal_model().recalled_per_pedestrian()?;
    }
    let mut measuring = Measuring { model, test: &test, request, observe, done: 0, total };
    let mut rows = Vec::new();
    if asked(&[Protocol::Published]) {
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
    Ok(Evaluation { rows, ..results })
}

/// The model's own goals for a variant; `None` for the published goals, which another estimator makes.
fn goals_for(
    given: GivenGoals,
    model: &GoalModel,
    windows: &[Window],
    own_goals: &[Vec<GoalSet>],
) -> Result<Vec<Vec<GoalSet>>, ForecastError> {
    match given {
        GivenGoals::Own | GivenGoals::Published => Ok(own_goals.to_vec()),
        GivenGoals::Central => Ok(sets::with_central_only(windows, own_goals)),
        GivenGoals::WithoutLibrary => model.goals_without_library(windows),
        GivenGoals::WithoutMemory => {
            let nothing = |window: &Window| window.clone().with_remembered(|_| Vec::new());
            model.goals(&windows.iter().map(nothing).collect::<Vec<_>>())
        }
    }
}

/// Forecasts of the model, and straight lines to its goals; one of each for each window.
struct Forecasts {
    /// One list for each variant.
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
    fn without_future(&mut self, shown_alike: &[Protocol], windows: &[Window]) -> Result<Evaluation, DdlError> {
        let protocols: Vec<Protocol> = shown_alike.iter().copied().filter(|p| self.asked(*p)).collect();
        let Some(&first) = protocols.first() else {
            return Ok(Evaluation::default());
        };
        let model = self.model;
        let mut variants = EvaluationVariant::all(model, &self.request.protocols);
        variants.retain(|variant| protocols.contains(&variant.protocol));
        // Straight lines lead to several goals.
        let lines_asked = protocols.iter().any(|p| p.hypotheses() > 1);
        // The estimator copies the expert library, so make it only when it is needed.
        let has_published_goals = |variant: &EvaluationVariant| variant.goals == GivenGoals::Published;
        let published = if variants.iter().any(has_published_goals) {
            Some(model.goal_model().published_estimator(QuerySpan::Observed)?)
        } else {
            None
        };
        let forecasts = self.forecast(first, windows, variants.len(), |windows| {
            let goals = model.goal_model().goals(windows)?;
            let towards = |variant: &EvaluationVariant| {
                let goals = match &published {
                    Some(estimator) if has_published_goals(variant) => sets::retrieved(estimator, windows)?,
                    _ => goals_for(variant.goals, model.goal_model(), windows, &goals)?,
                };
                match variant.motion {
                    VariantMotion::Shaped(integrator) => model.forecast_towards(windows, goals, integrator),
                    VariantMotion::Neutral => model.forecast_neutral(windows, goals),
                    VariantMotion::Scenes => {
                        let answers = model.forecast(windows, &Request::joint())?;
                        Ok(answers.into_iter().map(Answer::into_forecast).collect())
                    }
                }
            };
            Ok(Forecasts {
                model: variants.iter().map(towards).collect::<Result<_, _>>()?,
                lines: if lines_asked { straight_lines(windows, weighted(&goals)?)? } else { Vec::new() },
            })
        })?;
        let mut evaluation = Evaluation::default();
        for &protocol in &protocols {
            evaluation.rows.extend(self.rows_of(protocol, &variants, &forecasts)?);
        }
        if protocols.contains(&Protocol::Fair) {
            evaluation.moments = self.moments(&forecasts.model[0])?;
        }
        let is_scenes = |variant: &EvaluationVariant| matches!(variant.motion, VariantMotion::Scenes);
        if let Some(at) = variants.iter().position(is_scenes) {
            evaluation.scenes = self.scenes(&forecasts.model[at]);
        }
        Ok(evaluation)
    }

    /// The rows of one protocol.
    fn rows_of(
        &self,
        protocol: Protocol,
        variants: &[EvaluationVariant],
        forecasts: &Forecasts,
    ) -> Result<Vec<ResultRow>, DdlError> {
        let model = self.model;
        let admit = |forecasts: &[Forecast], name: &str| protocol.admit(forecasts.to_vec(), name);
        let mut named_forecasts = Vec::new();
        for (variant, forecasts) in variants.iter().zip(&forecasts.model) {
            if variant.protocol == protocol {
                let admitted = admit(forecasts, &model.name())?;
                named_forecasts.push(NamedForecasts::model(
                    &model.name(),
                    admitted,
                    variant.change.as_deref(),
                    variant.goal_words(model),
                    words::selection(model.config().patience),
                ));
            }
        }
        if protocol.hypotheses() > 1 {
            let lines = admit(&forecasts.lines, "straight line")?;
            let goals = model.goal_model().words() + &memory_words(protocol, model);
            let recipe = format!("goals {goals}");
            named_forecasts.push(NamedForecasts::lines_to(ESTIMATED_GOALS, recipe, lines));
        }
        self.rows(protocol).of(&named_forecasts)
    }

    fn scenes(&self, forecasts: &[Forecast]) -> Vec<(Window, Forecast)> {
        let widest = self.test.rules.last().map_or(&[][..], |(_, indices)| indices);
        widest.iter().map(|&at: &usize| (self.test.windows[at].clone(), forecasts[at].clone())).collect()
    }

    /// Windows for display, from the model's forecasts for each window of the test set.
    fn moments(&self, forecasts: &[Forecast]) -> Result<Vec<ForecastSnapshot>, DdlError> {
        let (windows, forecasts): (Vec<Window>, Vec<Forecast>) = self
            .test
            .headline_indices()
            .map(|index| (self.test.windows[index].clone(), forecasts[index].clone()))
            .unzip();
        Ok(gallery::moments(&self.test.fold, &self.model.name(), &windows, &forecasts)?)
    }

    /// Evaluates the best epoch, then the last epoch, then also without the future frame, then also without noise.
    fn published(&mut self) -> Result<Vec<ResultRow>, DdlError> {
        let protocol = Protocol::Published;
        let (model, test) = (self.model, self.test);
        let estimator = |query| model.goal_model().published_estimator(query);
        let reading_on = estimator(QuerySpan::PublishedFuture)?;
        let windows: Vec<Window> = test.headline().cloned().collect();
        let report = |pedestrians| self.report(pedestrians, protocol);
        let [best, last] = Published::best_on_test_and_last(model, &reading_on, &windows, report)?;
        let mut estimators = vec![reading_on];
        let variant = |network, estimator, noise, change| OracleVariant { network, estimator, noise, change };
        let mut variants =
            vec![variant(&best, 0, best.samples, None), variant(&last, 0, last.samples, Some("of its last epoch"))];
        if model.config().star.variant.uses_goal() {
            estimators.push(estimator(QuerySpan::Observed)?);
            let change = "of its last epoch without the future frame";
            variants.push(variant(&last, 1, last.samples, Some(change)));
            let change = "of its last epoch without the future frame and noise";
            variants.push(variant(&last, 1, Noise::Expected, Some(change)));
        }
        let forecasts = self.forecast(protocol, &test.windows, variants.len(), |windows| {
            let goals = estimators.iter().map(|one| sets::nearest_true_end(one, windows));
            let goals = goals.collect::<Result<Vec<_>, _>>()?;
            let certain = |goals: &Vec<Position>| goals.iter().map(|&goal| WeightedGoals::certain(goal)).collect();
            let lines = straight_lines(windows, goals[0].iter().map(certain).collect())?;
            let of_variant = |variant: &OracleVariant<'_>| {
                let goals = &goals[variant.estimator];
                variant.network.forecast_towards(windows, goals, variant.noise)
            };
            let model = variants.iter().map(of_variant).collect::<Result<_, _>>()?;
            Ok(Forecasts { model, lines })
        })?;
        let (name, goals) = (model.name(), model.goal_model().words());
        let chosen = match self.request.on {
            Split::Test => "best kept epoch on the TEST windows of the headline rule",
            Split::Validation => "best kept epoch on the VALIDATION windows of the headline rule",
        };
        let named = variants.iter().zip(forecasts.model);
        let mut named: Vec<_> = named
            .map(|(OracleVariant { change, .. }, forecasts)| {
                let selection = change.map_or(chosen, |_| words::selection(None));
                NamedForecasts::model(&name, forecasts, *change, goals.clone(), selection)
            })
            .collect();
        let goal = "the estimated goal nearest the TRUE end";
        let recipe = "goals of the published estimator".to_owned();
        named.push(NamedForecasts::lines_to(goal, recipe, forecasts.lines));
        self.rows(protocol).of(&named)
    }

    /// Forecasts all windows in several variants, in parts. The model sees the futures only if the protocol shows
    /// them.
    fn forecast(
        &mut self,
        protocol: Protocol,
        windows: &[Window],
        variants: usize,
        forecast_some: impl Fn(&[Window]) -> Result<Forecasts, ForecastError>,
    ) -> Result<Forecasts, DdlError> {
        let mut forecasts = Forecasts { model: vec![Vec::new(); variants], lines: Vec::new() };
        for part in parts(windows) {
            let some = forecast_some(&protocol.visible(part))?;
            for (forecasts, some) in forecasts.model.iter_mut().zip(some.model) {
                forecasts.extend(scored(part, some));
            }
            forecasts.lines.extend(scored(part, some.lines));
            self.report(pedestrians(part), protocol)?;
        }
        Ok(forecasts)
    }

    fn rows(&self, protocol: Protocol) -> ResultRows<'_> {
        ResultRows { model: self.model, test: self.test, protocol, commit: &self.request.commit }
    }

    fn asked(&self, protocol: Protocol) -> bool {
        self.request.protocols.contains(&protocol)
    }

    fn report(&mut self, pedestrians: usize, protocol: Protocol) -> Result<(), DdlError> {
        self.done += pedestrians;
        let progress =
            EvaluationProgress { pedestrians: WorkDone { done: self.done as u64, total: self.total as u64 }, protocol };
        match (self.observe)(&progress) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(DdlError::Interrupted),
        }
    }
}
