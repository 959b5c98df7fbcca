//! The benchmark for custom models: windows without their futures, the forecasts for them, and their scores.

use crate::arrays::{Paths, array, forecast, numbers};
use crate::errors::{ensure, of_any, parsed, raised};
use crate::forecasts::names;
use crate::interruptible::{Stop, User, run, run_on};
use crate::model::ForecastModel;
use crate::moments::UserMoments;
use crate::recording::Recording;
use ddl::data::{Convention, Dataset, HORIZON, OBSERVED, Window, WindowRule, locate};
use ddl::eval::{Conditions, Protocol, ResultRow};
use ddl::report::Report;
use ddl::{DdlError, EvaluationRequest};
use numpy::{PyReadonlyArray2, PyReadonlyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::channel;

fn dataset(convention: Convention, folder: Option<PathBuf>) -> Result<Dataset, DdlError> {
    if convention == Convention::Simulated {
        return Ok(Dataset::simulated(Dataset::CROWD_SEED));
    }
    let folder = locate(convention, folder.as_deref())?;
    Ok(Dataset::load(convention, &folder)?)
}

/// The conventions, with their folds.
#[pyfunction]
pub(crate) fn conventions() -> Vec<(&'static str, Vec<&'static str>)> {
    let planned = Convention::ALL.into_iter().filter(|it| *it != Convention::Own);
    planned.map(|it| (it.name(), it.fold_names().collect())).collect()
}

/// The windows of a fold, or of a recording, with their futures.
#[pyfunction]
pub(crate) fn windows<'py>(
    py: Python<'py>,
    convention: &str,
    folder: Option<PathBuf>,
    fold: &str,
    part: &str,
    rule: Option<&str>,
    recording: Option<&Recording>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let convention: Convention = parsed(convention)?;
    let rule: WindowRule = rule.map_or(Ok(convention.headline_rule()), parsed)?;
    let windows = if let Some(recording) = recording {
        recording.tracks.windows(rule)
    } else {
        let dataset = run(py, move |_| dataset(convention, folder))?.map_err(raised)?;
        let fold = dataset.fold(fold).map_err(raised)?;
        match part {
            "test" => fold.test_windows(rule),
            "training" => fold.training_windows(rule),
            _ => {
                return Err(PyValueError::new_err(format!("part must be 'test' or 'training', found {part:?}")));
            }
        }
    };
    let moments = recording.map(|recording| recording.moments);
    windows.iter().map(|window| window_parts(py, window, moments)).collect()
}

/// Without `moments` the ticks of the window are frame numbers.
fn window_parts<'py>(py: Python<'py>, window: &Window, moments: Option<UserMoments>) -> PyResult<Bound<'py, PyDict>> {
    let n = window.len();
    let dict = PyDict::new(py);
    dict.set_item("recording", window.recording())?;
    let last = window.frames()[OBSERVED - 1];
    dict.set_item("frame", moments.unwrap_or(UserMoments::FRAMES).one(py, last)?)?;
    match moments {
        Some(moments) => dict.set_item("frame_step", moments.step(py)?)?,
        None => dict.set_item("frame_step", window.frame_step())?,
    }
    dict.set_item("ids", names(py, window)?)?;
    let past = (0..n).flat_map(|i| window.observed(i).to_vec()).collect();
    dict.set_item("past", array(py, numbers(past), [n, OBSERVED, 2])?)?;
    if window.has_future() {
        let future = (0..n).flat_map(|i| window.future(i).to_vec()).collect();
        dict.set_item("future", array(py, numbers(future), [n, HORIZON, 2])?)?;
    }
    Ok(dict)
}

/// The test windows of a fold. Their futures are not exposed to Python.
#[pyclass(frozen, module = "ddl_forecast._core")]
pub(crate) struct TestSet {
    convention: Convention,
    rule: WindowRule,
    fold: String,
    windows: Arc<Vec<Window>>,
    recordings: Vec<Recording>,
}

#[pymethods]
impl TestSet {
    #[new]
    fn new(
        py: Python<'_>,
        convention: &str,
        folder: Option<PathBuf>,
        fold: &str,
        rule: Option<&str>,
    ) -> PyResult<Self> {
        let convention: Convention = parsed(convention)?;
        let rule: WindowRule = rule.map_or(Ok(convention.headline_rule()), parsed)?;
        let dataset = run(py, move |_| dataset(convention, folder))?.map_err(raised)?;
        let fold_by_name = dataset.fold(fold).map_err(raised)?;
        let recordings = fold_by_name.test_recordings().iter().map(|tracks| Recording::of_ticks((*tracks).clone()));
        Ok(Self {
            convention,
            rule,
            fold: fold.to_owned(),
            windows: Arc::new(fold_by_name.test_windows(rule)),
            recordings: recordings.collect(),
        })
    }

    fn __len__(&self) -> usize {
        self.windows.len()
    }

    /// The recordings of the test windows.
    fn recordings(&self) -> Vec<Recording> {
        self.recordings.clone()
    }

    /// The recording of a window, its last observed frame, the past `(n, 8, 2)` of its pedestrians, and their ids.
    fn observed<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyDict>> {
        let window = self.windows.get(index).map(Window::without_future);
        let window = window.ok_or_else(|| PyValueError::new_err("there is no such window"))?;
        window_parts(py, &window, None)
    }

    /// Checks a forecast of a window: its shape, its numbers, and as many hypotheses as the protocol allows.
    #[staticmethod]
    fn check(
        protocol: &str,
        name: &str,
        pedestrians: usize,
        paths: Paths<'_>,
        weights: Option<PyReadonlyArray2<'_, f64>>,
        goals: Option<PyReadonlyArray3<'_, f64>>,
    ) -> PyResult<()> {
        let protocol: Protocol = parsed(protocol)?;
        let made = forecast(&paths, weights.as_ref(), goals.as_ref())?;
        ensure!(
            made.pedestrians() == pedestrians,
            "{} pedestrians were forecast, but {pedestrians} were given",
            made.pedestrians()
        );
        let admitted = protocol.admit(vec![made], name);
        admitted.map(drop).map_err(of_any)
    }

    /// Scores the forecasts (one for each window) under a protocol; returns a JSON object.
    fn score(
        &self,
        py: Python<'_>,
        protocol: &str,
        name: &str,
        forecasts: Vec<(Paths<'_>, Option<PyReadonlyArray2<'_, f64>>, Option<PyReadonlyArray3<'_, f64>>)>,
    ) -> PyResult<String> {
        let protocol: Protocol = parsed(protocol)?;
        let made = forecasts.iter().enumerate().map(|(index, (paths, weights, goals))| {
            forecast(paths, weights.as_ref(), goals.as_ref()).map_err(|error| {
                let frame = self.windows.get(index).map(Window::start_frame);
                PyValueError::new_err(format!("window {index} of {} (start frame {frame:?}): {error}", self.fold))
            })
        });
        let made: Vec<ddl::Forecast> = made.collect::<PyResult<_>>()?;
        // Bystanders were shown to the model, and are not scored.
        let scored = made.into_iter().zip(self.windows.iter());
        let made = scored.map(|(made, window)| made.without_bystanders(window)).collect();
        let admitted = protocol.admit(made, name).map_err(of_any)?;
        let conditions = Conditions::new(self.convention, self.rule, protocol, &self.fold, name);
        let windows = Arc::clone(&self.windows);
        let row = run(py, move |_| ResultRow::score(conditions, &windows, &admitted))?.map_err(of_any)?;
        serde_json::to_string(&row).map_err(of_any)
    }
}

/// The rows of the model on its own fold, as JSON objects; calls `progress(done, total)`, in pedestrians.
#[pyfunction]
pub(crate) fn evaluate_model(
    py: Python<'_>,
    model: &ForecastModel,
    folder: Option<PathBuf>,
    protocols: Vec<String>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<String>> {
    let protocols = protocols.iter().map(|word| parsed(word));
    let mut request = EvaluationRequest::new(protocols.collect::<PyResult<_>>()?);
    request.commit = String::new();
    let model = Arc::clone(&model.0);
    let (sender, receiver) = channel();
    let work = move |stop: &Stop| {
        let dataset = dataset(model.config().data.convention, folder)?;
        ddl::evaluate(&model, &dataset, &request, |now| {
            // Sending fails when the call was interrupted and the receiver was dropped.
            let sent = sender.send((now.pedestrians.done, now.pedestrians.total));
            if sent.is_err() || stop.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
    };
    let tell = |py: Python<'_>| {
        if let (Some(progress), Some(now)) = (&progress, receiver.try_iter().last()) {
            progress.call1(py, now)?;
        }
        Ok(())
    };
    let rows = run_on(User::Calls, py, work, tell)?.map_err(raised)?.rows;
    rows.iter().map(serde_json::to_string).collect::<Result<_, _>>().map_err(of_any)
}

/// A report of the rows, in Markdown.
#[pyfunction]
pub(crate) fn report(py: Python<'_>, title: &str, rows: Vec<String>) -> PyResult<String> {
    let rows = rows.iter().map(|row| serde_json::from_str(row));
    let rows: Vec<ResultRow> = rows.collect::<Result<_, _>>().map_err(of_any)?;
    let report = Report::new(title, rows).map_err(of_any)?;
    run(py, move |_| report.to_markdown())
}
