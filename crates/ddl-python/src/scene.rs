//! Plans, their risk, and occupancy, of joint futures.

use crate::arrays::{array, flat};
use crate::errors::{ensure, not_negative, of_any};
use crate::interruptible::run;
use ddl::data::HORIZON;
use ddl::scene::{Area, Futures, Occupancy, Plan, PlanPoint, SceneError};
use ddl::{Answer, Note};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::fmt;
use std::sync::Arc;

/// Joint futures of the pedestrians that were asked for; `None` if none of them can be forecast.
#[pyclass(frozen, name = "Futures", module = "ddl_forecast._core")]
#[derive(Debug, Clone)]
pub(crate) struct FuturesHandle {
    futures: Option<Arc<Futures>>,
    /// Whether they were given a plan.
    is_given: bool,
}

/// The plan of `(m, 4)` rows t, x, y and radius.
pub(crate) fn plan(rows: &PyReadonlyArray2<'_, f64>) -> PyResult<Plan> {
    Ok(plans_of(rows, &[rows.shape()[0]])?.remove(0))
}

/// From the rows of all plans, and the number of those of each.
fn plans_of(rows: &PyReadonlyArray2<'_, f64>, lengths: &[usize]) -> PyResult<Vec<Plan>> {
    ensure!(
        rows.shape()[1] == 4,
        "a plan must have the shape (m, 3) or (m, 4): t in seconds after the moment, x, y and radius in \
             metres; found {:?}",
        rows.shape()
    );
    let mut points = flat("plan", rows)?.as_chunks::<4>().0.iter();
    let point = |&[time, x, y, radius]: &[f64; 4]| PlanPoint { time, position: [x, y], radius };
    let of_each = lengths.iter().map(|&length| Plan::new(points.by_ref().take(length).map(point).collect()));
    of_each.collect::<Result<_, _>>().map_err(of_any)
}

impl FuturesHandle {
    /// Those of the pedestrians in these rows; `None` for an answer of each pedestrian alone, or without spread.
    pub(crate) fn of_rows(answer: &Answer, rows: &[Option<usize>]) -> Option<Self> {
        let futures = answer.futures().ok()?;
        futures.forecast().regions()?;
        let rows: Vec<usize> = rows.iter().copied().flatten().collect();
        let some = (!rows.is_empty()).then(|| Arc::new(futures.of_pedestrians(&rows)));
        Some(Self { futures: some, is_given: futures.plan().is_some() })
    }

    pub(crate) fn without_pedestrians(is_given: bool) -> Self {
        Self { futures: None, is_given }
    }
}

#[pymethods]
impl FuturesHandle {
    /// For p plans of these rows and lengths, which pedestrians see or not: the risk of each `(p,)`, of each pedestrian
    /// `(p, n)`, during each step and until its end `(p, 12)`; and texts about doubtful plans.
    fn risks<'py>(
        &self,
        py: Python<'py>,
        rows: PyReadonlyArray2<'py, f64>,
        lengths: Vec<usize>,
        within: f64,
        ego: Option<usize>,
        seen: bool,
    ) -> PyResult<([Py<PyAny>; 4], Vec<String>)> {
        not_negative("within", within)?;
        if seen && self.is_given {
            return Err(of_any(SceneError::PlanGiven));
        }
        let plans = plans_of(&rows, &lengths)?;
        let count = plans.len();
        let Some(futures) = self.futures.clone() else {
            let none = |width: usize| array(py, vec![0.0; count * width], [count, width]);
            let empty = [array(py, vec![0.0; count], [count])?, none(0)?, none(HORIZON)?, none(HORIZON)?];
            return Ok((empty, Vec::new()));
        };
        let names = (0..count).map(|index| fmt::from_fn(move |to| write!(to, "plans[{index}]")));
        let doubts = Note::of_plans(names.zip(&plans), &futures, ego);
        let people = futures.pedestrians();
        let risks = if seen { Futures::risks_if_seen } else { Futures::risks };
        let risks = run(py, move |_| risks(&futures, &plans, within, ego))?.map_err(of_any)?;
        let of_each = risks.iter().flat_map(|risk| risk.pedestrians.clone());
        let arrays = [
            array(py, risks.iter().map(|risk| risk.total).collect(), [count])?,
            array(py, of_each.collect(), [count, people])?,
            array(py, risks.iter().flat_map(|risk| risk.steps).collect(), [count, HORIZON])?,
            array(py, risks.iter().flat_map(|risk| risk.until).collect(), [count, HORIZON])?,
        ];
        Ok((arrays, doubts.iter().map(Note::to_string).collect()))
    }

    /// For p plans: the expected least distance `(p,)`, and that of each pedestrian `(p, n)`.
    fn clearances<'py>(
        &self,
        py: Python<'py>,
        rows: PyReadonlyArray2<'py, f64>,
        lengths: Vec<usize>,
    ) -> PyResult<[Py<PyAny>; 2]> {
        let plans = plans_of(&rows, &lengths)?;
        let count = plans.len();
        let Some(futures) = self.futures.clone() else {
            let no_pedestrians = array(py, Vec::<f64>::new(), [count, 0])?;
            return Ok([array(py, vec![f64::INFINITY; count], [count])?, no_pedestrians]);
        };
        let people = futures.pedestrians();
        let clearances = run(py, move |_| futures.clearances(&plans))?.map_err(of_any)?;
        let of_each = clearances.iter().flat_map(|clearance| clearance.pedestrians.clone());
        let nearest = clearances.iter().map(|clearance| clearance.nearest);
        Ok([array(py, nearest.collect(), [count])?, array(py, of_each.collect(), [count, people])?])
    }

    /// Probabilities `(times, height, width)`, times, and the lowest corner, of an area or of all paths and a margin;
    /// and how many are too far from the others for that.
    fn occupancy(
        &self,
        py: Python<'_>,
        options: (f64, f64, f64, f64),
        area: Option<[f64; 4]>,
    ) -> PyResult<(Py<PyAny>, Vec<f64>, [f64; 2], usize)> {
        let (cell, every, radius, margin) = options;
        let futures = self.futures.clone();
        let times = Occupancy::every(every).map_err(of_any)?;
        let area = match (area, &futures) {
            (Some([x0, y0, x1, y1]), _) => Area::new([x0, y0], [x1, y1], cell).map(|area| (area, Vec::new())),
            (None, Some(futures)) => futures.area(margin, cell, times.len()),
            (None, None) => return Err(PyValueError::new_err("no pedestrian could be forecast: give area=")),
        };
        not_negative("radius", radius)?;
        let (area, left_out) = area.map_err(of_any)?;
        area.ensure_kept(times.len()).map_err(of_any)?;
        let [width, height] = area.size();
        let grids = run(py, {
            let times = times.clone();
            move |stop| {
                let Some(futures) = futures else {
                    return Ok(vec![0.0; times.len() * width * height]);
                };
                let grids = futures.occupancy(&area, &times, radius)?.take_while(|_| !stop.is_asked());
                Ok(grids.flat_map(|grid| grid.probabilities).collect::<Vec<f32>>())
            }
        })?;
        let grids: Vec<f32> = grids.map_err(|error: ddl::scene::SceneError| of_any(error))?;
        Ok((array(py, grids, [times.len(), height, width])?, times, area.origin(), left_out.len()))
    }

    /// How a pickle makes it again.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Option<String>, bool))> {
        let json = self.futures.as_deref().map(serde_json::to_string).transpose().map_err(of_any)?;
        Ok((py.get_type::<Self>().getattr("of_json")?, (json, self.is_given)))
    }

    #[staticmethod]
    fn of_json(json: Option<&str>, is_given: bool) -> PyResult<Self> {
        let futures = json.map(serde_json::from_str).transpose().map_err(of_any)?;
        Ok(Self { futures: futures.map(Arc::new), is_given })
    }
}
