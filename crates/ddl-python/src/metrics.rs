//! The metrics of the evaluation, on arrays.

use crate::arrays::{Paths, array, forecast, tracks};
use crate::errors::{ensure, not_negative, of_any};
use crate::interruptible::run;
use ddl::Forecast;
use ddl::data::{HORIZON, OBSERVED, PedestrianId, Position, Window};
use ddl::eval::metric::amd::DistributionErrors;
use ddl::eval::metric::collision::{closest_approach, collides};
use ddl::eval::metric::displacement::DisplacementErrors;
use ddl::eval::metric::diversity::Diversity;
use ddl::eval::metric::kde::kde_nll as kde_of;
use ddl::eval::{ScoredWindow, Scores};
use numpy::{PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A scene with its true future. Without a past, each pedestrian stands at the first position of its future during the
/// observation.
fn window(
    start_frame: i64,
    truth: &PyReadonlyArray3<'_, f64>,
    past: Option<&PyReadonlyArray3<'_, f64>>,
) -> PyResult<Window> {
    let truth = tracks("truth", truth, HORIZON, false)?;
    let pasts = match past {
        Some(past) => tracks("past", past, OBSERVED, false)?,
        None => truth.iter().map(|future| vec![future[0]; OBSERVED]).collect(),
    };
    ensure!(pasts.len() == truth.len(), "past has {} pedestrians, truth has {}", pasts.len(), truth.len());
    let whole = pasts.into_iter().zip(truth);
    let whole: Vec<Vec<Position>> = whole.map(|(past, future)| [past, future].concat()).collect();
    let ids = (0..whole.len() as i64).map(PedestrianId).collect();
    Window::new("scene", start_frame, 1, ids, whole).map_err(of_any)
}

fn of_scene<T>(
    truth: &PyReadonlyArray3<'_, f64>,
    forecast: &Forecast,
    measure: impl FnOnce(&ScoredWindow<'_>) -> PyResult<T>,
) -> PyResult<T> {
    let window = window(0, truth, None)?;
    let scene = ScoredWindow::new(&window, forecast).map_err(of_any)?;
    measure(&scene)
}

/// ADE `(n, k)` and FDE `(n, k)` of every hypothesis, metres.
#[pyfunction]
pub(crate) fn displacement_errors(
    py: Python<'_>,
    paths: Paths<'_>,
    truth: PyReadonlyArray3<'_, f64>,
) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
    let forecast = forecast(&paths, None, None)?;
    of_scene(&truth, &forecast, |scene| {
        let errors = DisplacementErrors::of(scene);
        let shape = [forecast.pedestrians(), forecast.hypotheses()];
        let matrix = |row: fn(&DisplacementErrors, usize) -> &[f64]| {
            let rows = (0..shape[0]).flat_map(|i| row(&errors, i).to_vec());
            array(py, rows.collect(), shape)
        };
        Ok((matrix(DisplacementErrors::ade)?, matrix(DisplacementErrors::fde)?))
    })
}

/// KDE-NLL `(n,)`, nats.
#[pyfunction]
pub(crate) fn kde_nll(
    py: Python<'_>,
    paths: Paths<'_>,
    truth: PyReadonlyArray3<'_, f64>,
    weights: Option<PyReadonlyArray2<'_, f64>>,
) -> PyResult<Py<PyAny>> {
    let forecast = forecast(&paths, weights.as_ref(), None)?;
    of_scene(&truth, &forecast, |scene| {
        let n = forecast.pedestrians();
        array(py, several((0..n).map(|i| kde_of(scene, i)))?, [n])
    })
}

/// Mahalanobis distances `(n,)` of the truth, and the mean covariances `(n, 3)` as xx, xy, yy.
#[pyfunction]
pub(crate) fn mahalanobis(
    py: Python<'_>,
    paths: Paths<'_>,
    truth: PyReadonlyArray3<'_, f64>,
    weights: Option<PyReadonlyArray2<'_, f64>>,
) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
    let forecast = forecast(&paths, weights.as_ref(), None)?;
    of_scene(&truth, &forecast, |scene| {
        let n = forecast.pedestrians();
        let errors: Vec<DistributionErrors> = several((0..n).map(|i| DistributionErrors::of(scene, i)))?;
        let distances = errors.iter().map(|errors| errors.mahalanobis).collect();
        let covariances = errors.iter().map(|errors| errors.covariance);
        let covariances = covariances.flat_map(|it| [it.xx, it.xy, it.yy]).collect();
        Ok((array(py, distances, [n])?, array(py, covariances, [n, 3])?))
    })
}

/// Mean distances between two hypotheses, of paths `(n,)` and of endpoints `(n,)`, metres.
#[pyfunction]
pub(crate) fn spread_between(py: Python<'_>, paths: Paths<'_>) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
    let forecast = forecast(&paths, None, None)?;
    let n = forecast.pedestrians();
    let diversity: Vec<Diversity> = several((0..n).map(|i| Diversity::of(&forecast, i)))?;
    let paths = diversity.iter().map(|diversity| diversity.path).collect();
    let ends = diversity.iter().map(|diversity| diversity.ends).collect();
    Ok((array(py, paths, [n])?, array(py, ends, [n])?))
}

/// Whether each of `(n, t, 2)` tracks comes within two radii of another, `(n,)`, and its smallest distance to any
/// other, metres.
#[pyfunction]
pub(crate) fn collisions(
    py: Python<'_>,
    paths: PyReadonlyArray3<'_, f64>,
    radius: f64,
) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
    let steps = paths.shape()[1];
    ensure!(steps > 0, "paths have no steps");
    not_negative("radius", radius)?;
    let tracks = tracks("paths", &paths, steps, false)?;
    let slices: Vec<&[Position]> = tracks.iter().map(Vec::as_slice).collect();
    let n = slices.len();
    let nearest = |i: usize| {
        (0..n).filter(|j| *j != i).map(|j| closest_approach(slices[i], slices[j])).fold(f64::INFINITY, f64::min)
    };
    let (collides, nearest) = py.detach(|| {
        let nearest: Vec<f64> = (0..n).map(nearest).collect();
        (collides(&slices, radius), nearest)
    });
    Ok((array(py, collides, [n])?, array(py, nearest, [n])?))
}

/// All scores of several scenes together, as a JSON object.
#[pyfunction]
pub(crate) fn scores(
    py: Python<'_>,
    paths: Vec<Paths<'_>>,
    truth: Vec<PyReadonlyArray3<'_, f64>>,
    past: Vec<PyReadonlyArray3<'_, f64>>,
    weights: Vec<Option<PyReadonlyArray2<'_, f64>>>,
    goals: Vec<Option<PyReadonlyArray3<'_, f64>>>,
) -> PyResult<String> {
    let lengths = [truth.len(), past.len(), weights.len(), goals.len()];
    ensure!(
        lengths.iter().all(|length| *length == paths.len()),
        "paths, truth, past, weights and goals must have the same number of scenes"
    );
    let (mut windows, mut forecasts) = (Vec::new(), Vec::new());
    for (index, paths) in paths.iter().enumerate() {
        windows.push(window(index as i64, &truth[index], Some(&past[index]))?);
        let (weights, goals) = (weights[index].as_ref(), goals[index].as_ref());
        forecasts.push(forecast(paths, weights, goals)?);
    }
    let scores = run(py, move |_| Scores::evaluate(&windows, &forecasts))?.map_err(of_any)?;
    serde_json::to_string(&scores).map_err(of_any)
}

fn several<T>(values: impl Iterator<Item = Option<T>>) -> PyResult<Vec<T>> {
    values
        .collect::<Option<_>>()
        .ok_or_else(|| PyValueError::new_err("paths have one hypothesis, but this metric needs several"))
}
