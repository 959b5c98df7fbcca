//! A trained model.

use crate::arrays::{array, numbers};
use crate::errors::{ensure, of_any, raised};
use crate::forecasts::{EmptyFields, named_parts, parts};
use crate::interruptible::{Stop, run};
use crate::observed::{self, past_tracks};
use crate::recording::{Recording, doubt};
use crate::scene::plan;
use ddl::data::{Completeness, PedestrianId, Window};
use ddl::{
    Answer, Ddl, DdlError, DeviceChoice, GivenPlan, ModelSource, Motions, Note, ObservedPast, RecordingPlayer, Request,
    WindowOptions,
};
use numpy::{PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// Pedestrians that are forecast between two checks for Ctrl-C.
const BATCH: usize = 64;

#[pyclass(frozen, name = "Model", module = "ddl_forecast._core")]
#[derive(Debug)]
pub(crate) struct ForecastModel(pub(crate) Arc<Ddl>);

/// The request of these options.
fn request(model: &Ddl, samples: usize, certificates: bool, joint: bool) -> PyResult<Request> {
    let hypotheses = model.goal_model().clusters();
    ensure!(
        samples == 1 || samples == hypotheses,
        "samples must be {hypotheses} (all hypotheses of the model) or 1 (its central forecast); found {samples}. \
             Weights and regions belong to all {hypotheses}; for fewer, select those with the largest weights"
    );
    ensure!(!joint || samples != 1, "joint futures are of all hypotheses: leave out samples=1");
    let request = match (joint, samples) {
        (true, _) => Request::joint(),
        (false, 1) => Request::one(),
        _ => Request::default(),
    };
    Ok(if certificates { request.with_certificates() } else { request })
}

/// Answers for the windows in batches of pedestrians; stops between batches if the caller was interrupted.
fn answers_until(model: &Ddl, windows: &[Window], request: &Request, stop: &Stop) -> Result<Vec<Answer>, DdlError> {
    let mut answers = Vec::with_capacity(windows.len());
    for some in Window::parts(windows, BATCH).take_while(|_| !stop.is_asked()) {
        answers.extend(model.forecast(some, request)?);
    }
    Ok(answers)
}

#[pymethods]
impl ForecastModel {
    /// The built-in model of that name, or the model at that path.
    #[staticmethod]
    fn open(py: Python<'_>, name: PathBuf) -> PyResult<Self> {
        let opened = run(py, move |_| {
            // A built-in model takes precedence over a folder of that name, which is `./hotel`.
            let builtin = name.to_str().and_then(|name| name.parse().ok());
            let source = builtin.map_or_else(|| ModelSource::at(&name), ModelSource::Builtin);
            Ddl::open(&source, DeviceChoice::Cpu)
        })?;
        Ok(Self(Arc::new(opened.map_err(raised)?)))
    }

    #[staticmethod]
    fn builtin_names() -> Vec<&'static str> {
        ddl::BuiltinModel::ALL.map(ddl::BuiltinModel::name).to_vec()
    }

    #[getter]
    fn hypotheses(&self) -> usize {
        self.0.goal_model().clusters()
    }

    /// The convention and the fold that it was trained on.
    #[getter]
    fn trained_on(&self) -> (String, String) {
        let data = &self.0.config().data;
        (data.convention.to_string(), data.fold.clone())
    }

    #[getter]
    fn parameter_count(&self) -> usize {
        self.0.parameter_count() + self.0.goal_model().parameter_count()
    }

    /// Forecasts each scene: the first `asked[i]` pedestrians of `past[i]`. Also returns texts about doubtful positions
    /// and a doubtful plan.
    fn forecast<'py>(
        &self,
        py: Python<'py>,
        past: Vec<PyReadonlyArray3<'py, f64>>,
        asked: Vec<usize>,
        samples: usize,
        whole: bool,
        certificates: bool,
        joint: bool,
        given: Option<(PyReadonlyArray2<'py, f64>, Option<i64>)>,
    ) -> PyResult<(Vec<Bound<'py, PyDict>>, Vec<String>)> {
        let mut request = request(&self.0, samples, certificates, joint)?;
        if let Some((rows, ego)) = given {
            let (plan, ego) = (plan(&rows)?, ego.map(|row| PedestrianId(row).into()));
            request.motions = Motions::Given(GivenPlan { plan, ego });
        }
        let completeness = Completeness::of(whole);
        let pasts = past.iter().map(past_tracks).collect::<PyResult<Vec<_>>>()?;
        let scenes = run(py, move |_| {
            let scenes = pasts.par_iter().zip(asked);
            let scenes = scenes.map(|(past, asked)| ObservedPast::of_tracks(past, asked, completeness));
            scenes.collect::<Result<Vec<ObservedPast>, _>>()
        })?;
        let scenes = scenes.map_err(of_any)?;
        let windows: Vec<Window> = scenes.iter().filter_map(|scene| scene.window.clone()).collect();
        let empty = EmptyFields {
            hypotheses: if samples == 1 { 1 } else { self.hypotheses() },
            goals: self.0.config().star.variant.uses_goal(),
            certified: self.0.config().star.variant.dynamics() || samples == 1,
            regions: samples > 1,
            certificates,
            joint: joint.then(|| request.plan().is_some()),
        };
        let given = request.plan().cloned();
        let answers = self.answers(py, request, windows.clone())?;
        let pairs = windows.iter().zip(&answers);
        let notes = pairs.flat_map(|(window, answer)| Note::of_given(given.as_ref(), window, answer));
        let mut doubts: Vec<String> = scenes.iter().find_map(observed::doubt).into_iter().collect();
        doubts.extend(notes.map(|note| note.to_string()));
        let mut forecasts = answers.into_iter();
        let of_scene = |scene: &ObservedPast| {
            let forecast = scene.window.is_some().then(|| forecasts.next()).flatten();
            parts(py, scene, forecast.as_ref(), empty)
        };
        let forecasts = scenes.iter().map(of_scene).collect::<PyResult<_>>()?;
        Ok((forecasts, doubts))
    }

    /// Forecasts each moment of the recording with pedestrians to forecast, or only the last of them. Also returns text
    /// about doubtful positions.
    #[expect(clippy::fn_params_excessive_bools, reason = "switches of a Python function")]
    fn forecast_recording<'py>(
        &self,
        py: Python<'py>,
        recording: &Recording,
        last: bool,
        samples: usize,
        whole: bool,
        max_age: Option<f64>,
        every: Option<f64>,
        certificates: bool,
        joint: bool,
    ) -> PyResult<(Vec<Bound<'py, PyDict>>, Option<String>)> {
        let request = request(&self.0, samples, certificates, joint)?;
        let tracks = WindowOptions { whole, max_age, every, last }.tracks(recording.tracks.live_tracks());
        let observed = recording.observed(py, tracks.map_err(of_any)?, last)?;
        let forecasts = self.answers(py, request, observed.windows.clone())?;
        let pairs = observed.windows.iter().zip(&forecasts);
        let forecasts = pairs.map(|(window, forecast)| named_parts(py, window, forecast, recording.moments));
        Ok((forecasts.collect::<PyResult<_>>()?, doubt(&observed)))
    }

    /// Goals `(n, k, 2)` and weights `(n, k)`; NaN for pedestrians that cannot be forecast.
    fn goals(&self, py: Python<'_>, past: PyReadonlyArray3<'_, f64>, asked: usize) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
        let scene = ObservedPast::of_tracks(&past_tracks(&past)?, asked, Completeness::Partial).map_err(of_any)?;
        let k = self.hypotheses();
        let mut goals = vec![[f64::NAN; 2]; asked * k];
        let mut weights = vec![f64::NAN; asked * k];
        if let Some(window) = scene.window {
            let model = Arc::clone(&self.0);
            let mut sets = run(py, move |_| model.goal_model().goals(&[window]))?.map_err(of_any)?;
            let sets = sets.pop().unwrap_or_default();
            for (i, row) in scene.rows.iter().enumerate() {
                if let Some(set) = row.and_then(|row| sets.get(row)) {
                    goals[i * k..][..k].copy_from_slice(set.goals());
                    weights[i * k..][..k].copy_from_slice(set.weights());
                }
            }
        }
        Ok((array(py, numbers(goals), [asked, k, 2])?, array(py, weights, [asked, k])?))
    }

    /// Whether the model was trained on the tracks of the recording.
    fn was_trained_on(&self, py: Python<'_>, recording: &Recording) -> PyResult<bool> {
        let (model, recording) = (Arc::clone(&self.0), Arc::clone(&recording.tracks));
        run(py, move |_| model.goal_model().known_share(&recording).is_some())
    }

    /// A page that plays moments of the recording, and text about doubtful positions.
    fn page(
        &self,
        py: Python<'_>,
        recording: &Recording,
        most: usize,
        joint: bool,
    ) -> PyResult<(String, Option<String>)> {
        let observed = recording.observed(py, recording.tracks.live_tracks(), false)?;
        let doubt = doubt(&observed);
        ensure!(
            !observed.windows.is_empty(),
            "no pedestrian of the recording can be forecast; check fps, and that positions are in metres{}",
            doubt.map_or_else(String::new, |doubt| format!(": {doubt}"))
        );
        let player = RecordingPlayer {
            model: &self.0,
            recording: &recording.tracks,
            windows: &observed.windows,
            most: most.max(1),
        };
        let request = request(&self.0, self.hypotheses(), false, joint)?;
        let answers = self.answers(py, request, player.shown())?;
        let (name, clock) = (recording.tracks.name(), recording.moments.clock);
        let page = player.to_html(&answers, name, observed.warning.as_ref(), clock).map_err(raised)?;
        Ok((page, doubt))
    }
}

impl ForecastModel {
    fn answers(&self, py: Python<'_>, request: Request, windows: Vec<Window>) -> PyResult<Vec<Answer>> {
        let model = Arc::clone(&self.0);
        run(py, move |stop| answers_until(&model, &windows, &request, stop))?.map_err(raised)
    }
}
