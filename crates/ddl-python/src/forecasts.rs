//! Forecasts as arrays.

use crate::arrays::{Paths, array, forecast, numbers};
use crate::errors::{ensure, of_any};
use crate::moments::UserMoments;
use crate::scene::FuturesHandle;
use ddl::data::{HORIZON, OBSERVED, ObservationQuality, PedestrianId, PedestrianName, TIME_STEP, Window};
use ddl::{Answer, Forecast, Holding, ObservedPast, Pace, RegionTable, Spread};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::path::PathBuf;

/// The optional fields of the result for an empty window: those that the forecaster gives for other windows.
#[derive(Debug, Clone, Copy, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each tells whether one field is present")]
pub(crate) struct EmptyFields {
    pub(crate) hypotheses: usize,
    pub(crate) goals: bool,
    pub(crate) certified: bool,
    pub(crate) regions: bool,
    pub(crate) certificates: bool,
    /// Of joint futures, whether they were given a plan.
    pub(crate) joint: Option<bool>,
}

/// A forecast of the requested pedestrians; NaN for those that cannot be forecast.
///
/// Keys and shapes are those of the fields of `Forecast` in `_forecast.py`.
pub(crate) fn parts<'py>(
    py: Python<'py>,
    observed: &ObservedPast,
    answer: Option<&Answer>,
    empty: EmptyFields,
) -> PyResult<Bound<'py, PyDict>> {
    let forecast = answer.map(Answer::forecast);
    let rows = &observed.rows;
    let (n, k) = (rows.len(), forecast.map_or(empty.hypotheses, Forecast::hypotheses));
    let of_row = |row: &Option<usize>| Some((forecast?, (*row)?));
    let pairs = || rows.iter().map(of_row).flat_map(move |row| (0..k).map(move |k| (row, k)));
    let paths = pairs().flat_map(|(row, k)| match row {
        Some((forecast, i)) => forecast.hypothesis(i, k).to_vec(),
        None => vec![[f64::NAN; 2]; HORIZON],
    });
    let weights = pairs().map(|(row, k)| row.map_or(f64::NAN, |(forecast, i)| forecast.weight(i, k)));
    let goals = pairs().map(|(row, k)| row.and_then(|(forecast, i)| forecast.goal(i, k)).unwrap_or([f64::NAN; 2]));
    let certified = pairs().map(|(row, k)| row.and_then(|(forecast, i)| forecast.certified(i, k)) == Some(true));
    let familiarity =
        rows.iter().map(|row| of_row(row).and_then(|(forecast, i)| forecast.familiarity(i)).unwrap_or(f64::NAN));
    let dict = PyDict::new(py);
    observed_rows(py, observed, &dict)?;
    dict.set_item("paths", array(py, numbers(paths.collect()), [n, k, HORIZON, 2])?)?;
    dict.set_item("weights", array(py, weights.collect(), [n, k])?)?;
    let has_goals = forecast.map_or(empty.goals, Forecast::has_goals);
    let goals = has_goals.then(|| array(py, numbers(goals.collect()), [n, k, 2]));
    dict.set_item("goals", goals.transpose()?)?;
    let is_certified = forecast.map_or(empty.certified, |forecast| forecast.certified(0, 0).is_some());
    let certified = is_certified.then(|| array(py, certified.collect(), [n, k]));
    dict.set_item("certified", certified.transpose()?)?;
    dict.set_item("familiarity", array(py, familiarity.collect(), [n])?)?;
    spread_and_regions(py, rows, forecast, empty, &dict)?;
    let without_pedestrians = || empty.joint.map(FuturesHandle::without_pedestrians);
    let futures = answer.map_or_else(without_pedestrians, |answer| FuturesHandle::of_rows(answer, rows));
    dict.set_item("futures", futures)?;
    let has_evidence = answer.map_or(empty.certificates, |answer| !answer.certificates().is_empty());
    let evidence = has_evidence.then(|| certificates(py, answer, rows, k));
    dict.set_item("certificates", evidence.transpose()?)?;
    Ok(dict)
}

/// The spread around the hypotheses, and the table of the regions.
fn spread_and_regions(
    py: Python<'_>,
    rows: &[Option<usize>],
    forecast: Option<&Forecast>,
    empty: EmptyFields,
    dict: &Bound<'_, PyDict>,
) -> PyResult<()> {
    let of_row = |row: &Option<usize>| Some((forecast?, (*row)?));
    let spread = rows.iter().flat_map(|row| {
        (0..HORIZON).map(move |t| of_row(row).and_then(|(forecast, i)| forecast.scale(i, t)).unwrap_or(f64::NAN))
    });
    let table = match forecast {
        Some(forecast) => forecast.regions(),
        None => empty.regions.then(ddl::region_table),
    };
    let spread = table.map(|_| array(py, spread.collect(), [rows.len(), HORIZON]));
    dict.set_item("spread", spread.transpose()?)?;
    let table = table.map(serde_json::to_string).transpose();
    dict.set_item("region_table", table.map_err(of_any)?)
}

/// The observation, and how well it is known.
fn observed_rows(py: Python<'_>, observed: &ObservedPast, dict: &Bound<'_, PyDict>) -> PyResult<()> {
    let (window, rows) = (observed.window.as_ref(), &observed.rows);
    let n = rows.len();
    let qualities = || rows.iter().map(|row: &Option<usize>| window.zip(*row).map(|(window, i)| window.quality(i)));
    let unseen = qualities().map(|quality| quality.map_or(0, |quality| quality.unseen as i64));
    let age = qualities().map(|quality| quality.map_or(f64::NAN, |quality| quality.age));
    let deviation = qualities().map(|quality| quality.map_or(f64::NAN, |quality| quality.deviation));
    let uncertainty = qualities().map(|quality| quality.map_or(f64::NAN, ObservationQuality::uncertainty));
    let past = rows.iter().flat_map(|row| match window.zip(*row) {
        Some((window, i)) => window.observed(i).to_vec(),
        None => vec![[f64::NAN; 2]; OBSERVED],
    });
    dict.set_item("past", array(py, numbers(past.collect()), [n, OBSERVED, 2])?)?;
    dict.set_item("unseen", array(py, unseen.collect(), [n])?)?;
    dict.set_item("age", array(py, age.collect(), [n])?)?;
    dict.set_item("deviation", array(py, deviation.collect(), [n])?)?;
    dict.set_item("uncertainty", array(py, uncertainty.collect(), [n])?)
}

/// As [`parts`], with pedestrians, frames and recording.
pub(crate) fn named_parts<'py>(
    py: Python<'py>,
    window: &Window,
    answer: &Answer,
    moments: UserMoments,
) -> PyResult<Bound<'py, PyDict>> {
    let observed = ObservedPast::of_window(window.clone());
    let dict = parts(py, &observed, Some(answer), EmptyFields::default())?;
    dict.set_item("ids", names(py, window)?)?;
    let last = window.frames()[OBSERVED - 1];
    let ahead = (1..=HORIZON as i64).map(|t| last + t * window.frame_step());
    dict.set_item("frame", moments.one(py, last)?)?;
    dict.set_item("frames", moments.all(py, ahead.collect())?)?;
    dict.set_item("recording", window.recording())?;
    Ok(dict)
}

/// The ids of the pedestrians of a window: numbers, or words if the recording has words.
pub(crate) fn names<'py>(py: Python<'py>, window: &Window) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for i in 0..window.len() {
        match window.name(i) {
            PedestrianName::Number(number) => list.append(number)?,
            PedestrianName::Word(word) => list.append(word)?,
        }
    }
    Ok(list)
}

fn certificates<'py>(
    py: Python<'py>,
    answer: Option<&Answer>,
    rows: &[Option<usize>],
    k: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let n = rows.len();
    let mut potentials = Vec::with_capacity(n * k * (HORIZON + 1));
    let [mut eigenvalues, mut margins, mut angles] = [const { Vec::new() }; 3];
    for row in rows {
        for k in 0..k {
            let of_row = answer.zip(*row).and_then(|(answer, i)| answer.certificate(i, k));
            let Some(certificate) = of_row else {
                potentials.extend([f64::NAN; HORIZON + 1]);
                for values in [&mut eigenvalues, &mut margins, &mut angles] {
                    values.push(f64::NAN);
                }
                continue;
            };
            potentials.extend(certificate.potentials());
            eigenvalues.push(certificate.min_eigenvalue().unwrap_or(f64::NAN));
            margins.push(certificate.min_step_margin().unwrap_or(f64::NAN));
            angles.push(certificate.largest_angle());
        }
    }
    let dict = PyDict::new(py);
    dict.set_item("potentials", array(py, potentials, [n, k, HORIZON + 1])?)?;
    dict.set_item("min_eigenvalue", array(py, eigenvalues, [n, k])?)?;
    dict.set_item("min_step_margin", array(py, margins, [n, k])?)?;
    dict.set_item("largest_angle", array(py, angles, [n, k])?)?;
    Ok(dict)
}

/// Radii `(n, k, 12)` of the discs around the hypotheses in the region of a level; NaN where there is no disc.
#[pyfunction]
pub(crate) fn region_radii<'py>(
    py: Python<'py>,
    observed: (PyReadonlyArray3<'py, f64>, PyReadonlyArray1<'py, f64>),
    weights: PyReadonlyArray2<'py, f64>,
    spread: PyReadonlyArray2<'py, f64>,
    region_table: &str,
    wanted: (f64, &str),
) -> PyResult<Py<PyAny>> {
    let ((past, uncertainty), (level, of)) = (observed, wanted);
    let table: RegionTable = serde_json::from_str(region_table).map_err(of_any)?;
    let [low, high] = table.range();
    ensure!((low..=high).contains(&level), "level must be a probability from {low} to {high}; found {level}");
    let [n, k] = [weights.shape()[0], weights.shape()[1]];
    let rows = weights.as_array();
    let forecast_rows: Vec<usize> = (0..n).filter(|&i| !rows[[i, 0]].is_nan()).collect();
    let invalid = |text: String| pyo3::exceptions::PyValueError::new_err(text);
    let holding = Holding::named(of).ok_or_else(|| invalid(format!("of must be step, path or scene; found {of}")))?;
    let table = table.holding(holding, forecast_rows.len());
    let table = table.ok_or_else(|| invalid(format!("the forecast is of a version without regions of a {of}")))?;
    let mut radii = vec![f64::NAN; n * k * HORIZON];
    if !forecast_rows.is_empty() {
        let of_known = forecast_rows.iter().flat_map(|&i| rows.row(i).to_vec()).collect();
        let scales = forecast_rows.iter().flat_map(|&i| spread.as_array().row(i).to_vec());
        let paces = forecast_rows.iter().map(|&i| {
            let observed: Vec<_> = (0..OBSERVED).map(|t| [0, 1].map(|axis| past.as_array()[[i, t, axis]])).collect();
            Pace::of(&observed, TIME_STEP, uncertainty.as_array()[i])
        });
        let spread = Spread { scales: scales.collect(), paces: paces.collect(), regions: table.into() };
        let positions = vec![[0.0; 2]; forecast_rows.len() * k * HORIZON];
        let forecast = Forecast::new(forecast_rows.len(), k, positions, of_known, None)
            .and_then(|forecast| forecast.with_spread(spread))
            .map_err(of_any)?;
        for (place, i) in forecast_rows.into_iter().enumerate() {
            for (at, radius) in radii[i * k * HORIZON..][..k * HORIZON].iter_mut().enumerate() {
                let known = forecast.region_radius(place, at / HORIZON, at % HORIZON, level);
                *radius = known.unwrap_or(f64::NAN);
            }
        }
    }
    array(py, radii, [n, k, HORIZON])
}

/// Writes forecasts as JSON lines for `ddl evaluate --forecasts`.
#[pyfunction]
pub(crate) fn write_forecasts(
    path: PathBuf,
    forecasts: Vec<(
        String,
        i64,
        Vec<i64>,
        PyReadonlyArray3<'_, f64>,
        Paths<'_>,
        PyReadonlyArray2<'_, f64>,
        Option<PyReadonlyArray3<'_, f64>>,
    )>,
) -> PyResult<()> {
    let mut windows = Vec::new();
    let mut written = Vec::new();
    for (recording, frame, ids, past, paths, weights, goals) in forecasts {
        let tracks = crate::arrays::tracks("past", &past, OBSERVED, false)?;
        let ids = ids.into_iter().map(PedestrianId).collect();
        let start = frame - (OBSERVED as i64 - 1);
        let window = Window::new(recording, start, 1, ids, tracks).map_err(of_any)?;
        written.push(forecast(&paths, Some(&weights), goals.as_ref())?);
        windows.push(window);
    }
    let mut text = Vec::new();
    ddl::eval::external::write_forecasts(&windows, &written, &mut text).map_err(of_any)?;
    ddl::write_atomically(&path, &text).map_err(crate::errors::raised)
}
