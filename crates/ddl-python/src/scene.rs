//! Plans, their risk, and occupancy, from the arrays of joint futures.

use crate::arrays::{Paths, array, flat, forecast, tracks};
use crate::errors::{ensure, not_negative, of_any};
use crate::interruptible::run;
use ddl::data::{HORIZON, OBSERVED, ObservationQuality, PedestrianId, TIME_STEP, Window};
use ddl::scene::{Area, Futures, Occupancy, Plan, PlanPoint};
use ddl::{Pace, Spread};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Observed positions and the deviations of the last, paths, weights and spread of a joint forecast.
type JointArrays<'py> = (
    PyReadonlyArray3<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    Paths<'py>,
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray2<'py, f64>,
);

/// A plan of the rows t, x, y and radius.
pub(crate) fn plan(rows: &PyReadonlyArray2<'_, f64>) -> PyResult<Plan> {
    ensure!(
        rows.shape()[1] == 4,
        "a plan must have the shape (m, 3) or (m, 4): t in seconds after the moment, x, y and radius in \
             metres; found {:?}",
        rows.shape()
    );
    let points = flat("plan", rows)?.as_chunks::<4>().0.iter();
    let point = |&[time, x, y, radius]: &[f64; 4]| PlanPoint { time, position: [x, y], radius };
    Plan::new(points.map(point).collect()).map_err(of_any)
}

fn futures((past, deviations, paths, weights, spread): &JointArrays<'_>) -> PyResult<Futures> {
    let observed = tracks("past", past, OBSERVED, false)?;
    let ids = (0..observed.len() as i64).map(PedestrianId).collect();
    let paces = observed.iter().map(|track| Pace::of(track, TIME_STEP, 0.0)).collect();
    let quality = |&deviation: &f64| ObservationQuality { deviation, ..ObservationQuality::default() };
    let qualities = flat("deviation", deviations)?.iter().map(quality).collect();
    let window = Window::new("arrays", 0, 1, ids, observed).map_err(of_any)?.with_qualities(qualities);
    let spread =
        Spread { scales: flat("spread", spread)?.to_vec(), paces, regions: ddl::region_table().clone().into() };
    let forecast = forecast(paths, Some(weights), None)?.with_spread(spread).map_err(of_any)?;
    Futures::new(&window, forecast).map_err(of_any)
}

/// Checks the plans of a forecast that holds no pedestrian, whose risk is 0 without a computation.
#[pyfunction]
pub(crate) fn check_plans(plans: Vec<PyReadonlyArray2<'_, f64>>, within: f64) -> PyResult<()> {
    not_negative("within", within)?;
    plans.iter().try_for_each(|rows| plan(rows).map(drop))
}

/// For p plans, which pedestrians see or not: the risk of each `(p,)`, of each pedestrian `(p, n)`, during each step
/// and until its end `(p, 12)`.
#[pyfunction]
pub(crate) fn risks<'py>(
    py: Python<'py>,
    joint: JointArrays<'py>,
    plans: Vec<PyReadonlyArray2<'py, f64>>,
    within: f64,
    ego: Option<usize>,
    seen: bool,
) -> PyResult<[Py<PyAny>; 4]> {
    let futures = futures(&joint)?;
    let plans = plans.iter().map(plan).collect::<PyResult<Vec<_>>>()?;
    let (count, people) = (plans.len(), futures.pedestrians());
    let risks =
        run(
            py,
            move |_| {
                if seen { futures.risks_if_seen(&plans, within, ego) } else { futures.risks(&plans, within, ego) }
            },
        )?;
    let risks = risks.map_err(of_any)?;
    let of_each = risks.iter().flat_map(|risk| risk.pedestrians.clone());
    Ok([
        array(py, risks.iter().map(|risk| risk.total).collect(), [count])?,
        array(py, of_each.collect(), [count, people])?,
        array(py, risks.iter().flat_map(|risk| risk.steps).collect(), [count, HORIZON])?,
        array(py, risks.iter().flat_map(|risk| risk.until).collect(), [count, HORIZON])?,
    ])
}

/// For p plans: the expected least distance `(p,)`, and that of each pedestrian `(p, n)`.
#[pyfunction]
pub(crate) fn clearances<'py>(
    py: Python<'py>,
    joint: JointArrays<'py>,
    plans: Vec<PyReadonlyArray2<'py, f64>>,
) -> PyResult<[Py<PyAny>; 2]> {
    let futures = futures(&joint)?;
    let plans = plans.iter().map(plan).collect::<PyResult<Vec<_>>>()?;
    let (count, people) = (plans.len(), futures.pedestrians());
    let clearances = run(py, move |_| futures.clearances(&plans))?.map_err(of_any)?;
    let of_each = clearances.iter().flat_map(|clearance| clearance.pedestrians.clone());
    let nearest = clearances.iter().map(|clearance| clearance.nearest);
    Ok([array(py, nearest.collect(), [count])?, array(py, of_each.collect(), [count, people])?])
}

/// Probabilities `(times, height, width)`, times, and the lowest corner, of an area or of all paths and a margin.
#[pyfunction]
pub(crate) fn occupancy<'py>(
    py: Python<'py>,
    joint: JointArrays<'py>,
    options: (f64, f64, f64, f64),
    area: Option<[f64; 4]>,
) -> PyResult<(Py<PyAny>, Vec<f64>, [f64; 2])> {
    let (cell, every, radius, margin) = options;
    let futures = (joint.0.shape()[0] > 0).then(|| futures(&joint)).transpose()?;
    let area = match (area, &futures) {
        (Some([x0, y0, x1, y1]), _) => Area::new([x0, y0], [x1, y1], cell),
        (None, Some(futures)) => futures.area(margin, cell),
        (None, None) => return Err(PyValueError::new_err("no pedestrian could be forecast: give area=")),
    };
    not_negative("radius", radius)?;
    let area = area.map_err(of_any)?;
    let times = Occupancy::every(every).map_err(of_any)?;
    area.ensure_kept(times.len()).map_err(of_any)?;
    let [width, height] = area.size();
    let grids = run(py, {
        let times = times.clone();
        move |stop| {
            let Some(futures) = futures else {
                return Ok(vec![0.0; times.len() * width * height]);
            };
            let grids = futures.occupancy(&area, &times, radius)?;
            let grids = grids.take_while(|_| !stop.is_asked());
            Ok(grids.flat_map(|grid| grid.probabilities).collect::<Vec<f32>>())
        }
    })?;
    let grids: Vec<f32> = grids.map_err(|error: ddl::scene::SceneError| of_any(error))?;
    let grids = array(py, grids, [times.len(), height, width])?;
    Ok((grids, times, area.origin()))
}
