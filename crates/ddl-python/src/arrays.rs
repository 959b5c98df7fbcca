//! Conversion between numpy arrays and positions.

use crate::errors::{ensure, of_any};
use ddl::data::{COORDINATE_LIMIT, HORIZON, Position};
use numpy::ndarray::IntoDimension;
use numpy::{
    Element, IntoPyArray as _, PyArrayMethods as _, PyReadonlyArray, PyReadonlyArray2, PyReadonlyArray3,
    PyUntypedArrayMethods as _,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Moves a vector into an array of this shape, without a copy.
pub(crate) fn array<T: Element>(py: Python<'_>, flat: Vec<T>, shape: impl IntoDimension) -> PyResult<Py<PyAny>> {
    Ok(flat.into_pyarray(py).reshape(shape)?.into_any().unbind())
}

/// Positions as numbers, without a copy.
pub(crate) fn numbers(positions: Vec<Position>) -> Vec<f64> {
    positions.into_flattened()
}

/// The numbers of a contiguous array from the Python side.
pub(crate) fn flat<'a, T: Element, D: numpy::ndarray::Dimension>(
    name: &str,
    array: &'a PyReadonlyArray<'_, T, D>,
) -> PyResult<&'a [T]> {
    // `as_slice` also accepts arrays in Fortran order, whose numbers are in another order.
    let slice = array.as_slice().ok().filter(|_| array.is_c_contiguous());
    slice.ok_or_else(|| PyValueError::new_err(format!("{name} must be contiguous in C order")))
}

/// `(n, steps, 2)`: n tracks of `steps` finite positions (metres); with `nan`, NaN marks a missing observation.
pub(crate) fn tracks(
    name: &str,
    array: &PyReadonlyArray3<'_, f64>,
    steps: usize,
    nan: bool,
) -> PyResult<Vec<Vec<Position>>> {
    let shape = array.shape();
    ensure!(
        shape[1..] == [steps, 2],
        "{name} must have the shape (n, {steps}, 2): n pedestrians, {steps} positions 0.4 s apart, x and y in \
             metres; found {shape:?}"
    );
    let positions = flat(name, array)?.as_chunks::<2>().0;
    for (index, position) in positions.iter().enumerate() {
        let unseen = nan && position.iter().all(|coordinate| coordinate.is_nan());
        if !unseen && !position.iter().all(|coordinate: &f64| coordinate.abs() <= COORDINATE_LIMIT) {
            let [i, t] = [index / steps, index % steps];
            let rule = if nan { "NaN in both if the pedestrian was not observed" } else { "no NaN" };
            return Err(PyValueError::new_err(format!(
                "{name}[{i}, {t}] is {position:?}: a position is two finite numbers of at most 1e7 m, {rule}"
            )));
        }
    }
    Ok(positions.chunks_exact(steps).map(<[Position]>::to_vec).collect())
}

/// `(n, 2)` positions (metres), all finite.
pub(crate) fn points(name: &str, array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Position>> {
    let shape = array.shape();
    ensure!(shape[1] == 2, "{name} must have the shape (n, 2): x and y in metres; found {shape:?}");
    let points = flat(name, array)?.as_chunks::<2>().0;
    if let Some(row) = points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(PyValueError::new_err(format!(
            "{name}[{row}] is {:?}: positions must be finite numbers",
            points[row]
        )));
    }
    Ok(points.to_vec())
}

/// Hypotheses `(n, k, 12, 2)` with weights `(n, k)` (default 1/k each) and optional goals `(n, k, 2)`.
pub(crate) fn forecast(
    paths: &PyReadonlyArray<'_, f64, numpy::ndarray::Ix4>,
    weights: Option<&PyReadonlyArray2<'_, f64>>,
    goals: Option<&PyReadonlyArray3<'_, f64>>,
) -> PyResult<ddl::Forecast> {
    let shape = paths.shape();
    ensure!(
        shape[2..] == [HORIZON, 2],
        "paths must have the shape (n, k, 12, 2): n pedestrians, k hypotheses, 12 positions 0.4 s apart, x and y \
             in metres; found {shape:?}"
    );
    let [n, k] = [shape[0], shape[1]];
    let shape_of_goals = goals.map_or(vec![n, k, 2], |goals| goals.shape().to_vec());
    ensure!(
        shape_of_goals == [n, k, 2],
        "goals must have the shape ({n}, {k}, 2) of these paths; found {shape_of_goals:?}"
    );
    let shape_of_weights = weights.map_or(vec![n, k], |weights| weights.shape().to_vec());
    ensure!(
        shape_of_weights == [n, k],
        "weights must have the shape ({n}, {k}) of these paths; found {shape_of_weights:?}"
    );
    let positions = flat("paths", paths)?.as_chunks::<2>().0.to_vec();
    let weights = match weights {
        Some(weights) => flat("weights", weights)?.to_vec(),
        None => vec![1.0 / k.max(1) as f64; n * k],
    };
    let goals = goals.map(|goals| flat("goals", goals)).transpose()?;
    let goals = goals.map(|goals| goals.as_chunks::<2>().0.to_vec());
    ddl::Forecast::new(n, k, positions, weights, goals).map_err(of_any)
}

/// Paths from Python code, which has converted them to float64.
pub(crate) type Paths<'py> = PyReadonlyArray<'py, f64, numpy::ndarray::Ix4>;
