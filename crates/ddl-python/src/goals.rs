//! Goals from the user's own tracks.

use crate::arrays::{array, numbers, tracks};
use crate::errors::of_any;
use crate::interruptible::run;
use ddl::data::{OBSERVED, TIME_STEP, WINDOW};
use ddl::goal::{ExpertLibrary, GoalEstimatorParams};
use numpy::PyReadonlyArray3;
use pyo3::prelude::*;
use std::sync::Arc;

#[pyclass(frozen, module = "ddl_forecast._core")]
pub(crate) struct GoalEstimator(Arc<ddl::goal::GoalEstimator>);

#[pymethods]
impl GoalEstimator {
    #[new]
    #[pyo3(signature = (experts, *, similar = 800, goals = 20))]
    fn new(experts: PyReadonlyArray3<'_, f64>, similar: usize, goals: usize) -> PyResult<Self> {
        let tracks = tracks("experts", &experts, WINDOW, false)?;
        let library = ExpertLibrary::new(tracks, TIME_STEP).map_err(of_any)?;
        let params = GoalEstimatorParams { experts: similar, clusters: goals, ..Default::default() };
        Ok(Self(Arc::new(ddl::goal::GoalEstimator::new(params, library).map_err(of_any)?)))
    }

    fn __len__(&self) -> usize {
        self.0.library().tracks().len()
    }

    /// Goals `(n, k, 2)` and weights `(n, k)`.
    fn estimate(&self, py: Python<'_>, past: PyReadonlyArray3<'_, f64>) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
        let tracks = tracks("past", &past, OBSERVED, false)?;
        let (n, k) = (tracks.len(), self.0.params().clusters);
        let estimator = Arc::clone(&self.0);
        let sets = run(py, move |_| {
            let tracks: Vec<&[[f64; 2]]> = tracks.iter().map(Vec::as_slice).collect();
            estimator.estimate_batch(&tracks)
        })?;
        let sets = sets.map_err(of_any)?;
        let goals = sets.iter().flat_map(|set| set.goals().to_vec()).collect();
        let weights = sets.iter().flat_map(|set| set.weights().to_vec()).collect();
        Ok((array(py, numbers(goals), [n, k, 2])?, array(py, weights, [n, k])?))
    }
}
