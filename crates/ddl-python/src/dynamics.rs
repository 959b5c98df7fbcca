//! Flows to a goal in the plane.

use crate::arrays::{array, flat, points};
use crate::errors::{ensure, of_any};
use ddl::dynamics::{
    Attractor, CholeskyMetric, LyapunovCertificate, MetricSchedule, NaturalGradientFlow, StableEuler, State, rollout,
};
use nalgebra::{Matrix2, Vector2};
use numpy::{PyReadonlyArray2, PyReadonlyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Limit of the positions of one call, for all paths together: 1.6 GB.
const MOST_POSITIONS: usize = 100_000_000;

#[pyclass(frozen, module = "ddl_forecast._core")]
pub(crate) struct Flow(NaturalGradientFlow<f64, 2, MetricSchedule<f64, 2>>);

#[pymethods]
impl Flow {
    /// `metrics` `(steps, 2, 2)`, symmetric and positive definite; further steps use the last one.
    #[new]
    fn new(goal: [f64; 2], metrics: PyReadonlyArray3<'_, f64>) -> PyResult<Self> {
        let attractor = Attractor::new(goal.into()).map_err(of_any)?;
        let matrices = flat("P", &metrics)?.as_chunks::<4>().0.iter().enumerate();
        let metrics = matrices.map(|(step, &[xx, xy, yx, yy])| metric(step, [xx, xy, yx, yy]));
        let metrics: Vec<_> = metrics.collect::<PyResult<_>>()?;
        let schedule = MetricSchedule::new(metrics).map_err(of_any)?;
        Ok(Self(NaturalGradientFlow::new(attractor, schedule)))
    }

    fn velocity(&self, py: Python<'_>, position: PyReadonlyArray2<'_, f64>, step: usize) -> PyResult<Py<PyAny>> {
        let points = points("position", &position)?;
        let velocities = points.iter().map(|&point| {
            let state = State::new(point.into(), step, 0.0);
            let velocity = self.0.velocity(&state).map_err(of_any)?;
            Ok([velocity.x, velocity.y])
        });
        let velocities: Vec<[f64; 2]> = velocities.collect::<PyResult<_>>()?;
        let shape = [velocities.len(), 2];
        array(py, velocities.into_flattened(), shape)
    }

    /// `(n, steps + 1, 2)`, with the start first; the distance to the goal falls at each step.
    fn rollout(&self, py: Python<'_>, start: PyReadonlyArray2<'_, f64>, dt: f64, steps: usize) -> PyResult<Py<PyAny>> {
        let starts = points("start", &start)?;
        ensure!(
            steps.saturating_mul(starts.len()) <= MOST_POSITIONS,
            "{steps} steps from {} places are more than {MOST_POSITIONS} positions",
            starts.len()
        );
        let walk = |&start: &[f64; 2]| rollout(&self.0, &StableEuler, start.into(), dt, steps);
        let paths = py.detach(|| starts.iter().map(walk).collect::<Result<Vec<_>, _>>());
        let paths: Vec<Vec<Vector2<f64>>> = paths.map_err(of_any)?;
        let numbers = paths.iter().flatten().flat_map(|p| [p.x, p.y]).collect();
        array(py, numbers, [starts.len(), steps + 1, 2])
    }

    /// The certificate of a path `(steps + 1, 2)`.
    fn certificate<'py>(
        &self,
        py: Python<'py>,
        path: PyReadonlyArray2<'py, f64>,
        dt: f64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let path: Vec<Vector2<f64>> = points("path", &path)?.into_iter().map(Into::into).collect();
        let certificate = LyapunovCertificate::of_rollout(&self.0, &path, dt).map_err(of_any)?;
        let violation = certificate.verify().err();
        let potentials: Vec<f64> = certificate.potentials().collect();
        let length = [potentials.len()];
        let dict = PyDict::new(py);
        dict.set_item("holds", violation.is_none())?;
        dict.set_item("violation", violation.map(|violation| violation.to_string()))?;
        dict.set_item("potentials", array(py, potentials, length)?)?;
        dict.set_item("min_eigenvalue", certificate.min_eigenvalue().unwrap_or(f64::NAN))?;
        dict.set_item("min_step_margin", certificate.min_step_margin().unwrap_or(f64::NAN))?;
        dict.set_item("largest_angle", certificate.largest_angle())?;
        Ok(dict)
    }
}

/// P = L L^T + sigma I of a symmetric positive definite matrix, with half of its smallest eigenvalue as sigma.
fn metric(step: usize, [xx, xy, yx, yy]: [f64; 4]) -> PyResult<CholeskyMetric<f64, 2>> {
    let matrix = Matrix2::new(xx, xy, yx, yy);
    let finite = matrix.iter().all(|x| x.is_finite());
    let smallest = if finite { matrix.symmetric_eigenvalues().min() } else { f64::NAN };
    let symmetric = (xy - yx).abs() <= 1e-12 * (xx.abs() + yy.abs());
    // NaN is not positive
    ensure!(
        symmetric && smallest > 0.0,
        "P[{step}] is [[{xx}, {xy}], [{yx}, {yy}]]: it must be symmetric with positive eigenvalues, so that \
             v = -P grad Phi descends"
    );
    let sigma = 0.5 * smallest;
    let rest = matrix - Matrix2::from_diagonal_element(sigma);
    let factor = rest.cholesky().map(|factor| factor.l());
    let factor = factor
        .ok_or_else(|| PyValueError::new_err(format!("P[{step}] is too close to a matrix with an eigenvalue of 0")))?;
    CholeskyMetric::new(factor, sigma).map_err(of_any)
}
