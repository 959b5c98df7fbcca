//! Baselines: forecasts that need no training.

use crate::errors::{ensure, of_any};
use crate::forecasts::{EmptyFields, parts};
use crate::observed::past_tracks;
use ddl::data::{Completeness, Window};
use ddl::eval::baseline::{ConstantAcceleration, ConstantVelocity, SocialForce, StraightLine};
use ddl::{Answer, Forecaster, ObservedPast, WeightedGoals};
use numpy::{PyReadonlyArray3, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Forecasts the first `asked` pedestrians with the baseline `name`.
#[pyfunction]
pub(crate) fn baseline<'py>(
    py: Python<'py>,
    name: &str,
    past: PyReadonlyArray3<'py, f64>,
    asked: usize,
    seed: u64,
    goals: Option<PyReadonlyArray3<'py, f64>>,
) -> PyResult<Bound<'py, PyDict>> {
    let scene = ObservedPast::of_tracks(&past_tracks(&past)?, asked, Completeness::Partial).map_err(of_any)?;
    let forecaster: Box<dyn Forecaster + Send + Sync> = match name {
        "constant_velocity" => Box::new(ConstantVelocity::LastStep),
        "mean_velocity" => Box::new(ConstantVelocity::MeanObserved),
        "angular_noise" => Box::new(ConstantVelocity::AngularNoise { seed }),
        "constant_acceleration" => Box::new(ConstantAcceleration),
        "social_force" => Box::new(SocialForce),
        "straight_line" => Box::new(StraightLine(given(goals.as_ref(), &scene)?)),
        _ => return Err(PyValueError::new_err(format!("there is no baseline {name:?}"))),
    };
    let window = scene.window.as_ref();
    let forecast = window.map(|window| py.detach(|| forecaster.forecast(window)));
    let forecast = forecast.transpose().map_err(of_any)?.map(Answer::from);
    let goals = goals.map(|goals| goals.shape()[1]);
    let many = if name == "angular_noise" { 20 } else { 1 };
    let empty = EmptyFields { hypotheses: goals.unwrap_or(many), goals: goals.is_some(), ..EmptyFields::default() };
    parts(py, &scene, forecast.as_ref(), empty)
}

/// The goals `(n, k, 2)` of the pedestrians in the window, equally likely.
fn given(goals: Option<&PyReadonlyArray3<'_, f64>>, scene: &ObservedPast) -> PyResult<Vec<WeightedGoals>> {
    let goals = goals.ok_or_else(|| PyValueError::new_err("goals are missing"))?;
    let shape = goals.shape();
    ensure!(
        shape[0] == scene.rows.len() && shape[2] == 2 && shape[1] > 0,
        "goals must have the shape ({}, k, 2); found {shape:?}",
        scene.rows.len()
    );
    let k = shape[1];
    let flat = crate::arrays::flat("goals", goals)?.as_chunks::<2>().0;
    let mut of_window = vec![None; scene.window.as_ref().map_or(0, Window::len)];
    for (i, row) in scene.rows.iter().enumerate() {
        if let Some(row) = row {
            let goals = WeightedGoals::new(flat[i * k..][..k].to_vec(), vec![1.0 / k as f64; k]);
            of_window[*row] = Some(goals.map_err(of_any)?);
        }
    }
    let goals: Option<Vec<WeightedGoals>> = of_window.into_iter().collect();
    goals.ok_or_else(|| PyValueError::new_err("neighbours have no goals; leave them out"))
}
