//! Soft-DTW of numpy arrays of any length, with up to 128 components.

use crate::arrays::array;
use crate::errors::{ensure, of_any};
use crate::interruptible::run;
use ddl::softdtw::{Neighbour, SearchError, SearchIndex as Index, SoftDtw};
use numpy::{PyArray2, PyArrayMethods as _, PyReadonlyArray2, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::borrow::Cow;
use std::sync::Arc;

/// Evaluates `$body` with `$D` the compiled number of components: the requested number or the next larger one.
/// Additional components are 0 in every step and do not change distances.
macro_rules! in_dimension {
    ($components:expr, $D:ident => $body:expr) => {
        match $components {
            1..=2 => {
                const $D: usize = 2;
                $body
            }
            3..=4 => {
                const $D: usize = 4;
                $body
            }
            5..=8 => {
                const $D: usize = 8;
                $body
            }
            // Each number is compiled separately, and many components are rare.
            9..=128 => {
                const $D: usize = 128;
                $body
            }
            components => {
                Err(PyValueError::new_err(format!("a step must have 1 to 128 components, found {components}")))
            }
        }
    };
}

/// A sequence: an array `(steps, components)`, or `(steps,)` of single numbers. Contiguous float64 is not copied.
fn sequence<'py>(object: &Bound<'py, PyAny>, name: &str) -> PyResult<PyReadonlyArray2<'py, f64>> {
    let numpy = object.py().import("numpy")?;
    ensure!(
        !(object.hasattr("mask")? && numpy.getattr("ma")?.call_method1("is_masked", (object,))?.is_truthy()?),
        "{name} has masked values: leave out these steps"
    );
    if let Ok(array) = object.cast::<PyArray2<f64>>()
        && array.is_c_contiguous()
    {
        return Ok(array.readonly());
    }
    let array = numpy.call_method1("ascontiguousarray", (object, "float64"))?;
    let array = match array.getattr("ndim")?.extract::<usize>()? {
        1 => array.call_method1("reshape", (-1, 1))?,
        _ => array,
    };
    let array = array
        .cast_into::<PyArray2<f64>>()
        .map_err(|_| PyValueError::new_err(format!("{name} must have the shape (steps, components) or (steps,)")))?;
    Ok(array.readonly())
}

/// The steps of a sequence with `D` components; 0 is added for missing components.
fn steps<'a, const D: usize>(
    array: &'a PyReadonlyArray2<'_, f64>,
    components: usize,
    name: &str,
) -> PyResult<Cow<'a, [[f64; D]]>> {
    let shape = array.shape();
    ensure!(
        shape[1] == components,
        "{name} has {} components per step, but {components} are expected; all sequences must have the same number",
        shape[1]
    );
    let flat = array.as_slice()?;
    if components == D {
        return Ok(Cow::Borrowed(flat.as_chunks::<D>().0));
    }
    let widened = flat.chunks_exact(components).map(|step| {
        let mut wide = [0.0; D];
        wide[..components].copy_from_slice(step);
        wide
    });
    Ok(Cow::Owned(widened.collect()))
}

/// Limit of the cells of a gradient; at 24 bytes each, 12 GB.
const MOST_CELLS: usize = 500_000_000;
/// Number of cells above which the GIL is released.
const LONG: usize = 20_000;

/// Computes without the GIL if the work takes longer than releasing it.
fn unlocked<T: Send>(py: Python<'_>, cells: usize, work: impl Send + FnOnce() -> T) -> T {
    if cells < LONG { work() } else { py.detach(work) }
}

/// Soft-DTW of two sequences.
///
/// Parameters
/// ----------
/// x, y
///     (n, components) and (m, components), or (n,) and (m,).
/// gamma
///     Smoothing, in the unit of the squared distance of two steps; 0 is hard DTW.
/// normalised
///     D(x, y) - (D(x, x) + D(y, y)) / 2, which is 0 for x = y.
///
/// Raises
/// ------
/// ValueError
///     A sequence is empty or not finite, or the components differ.
#[pyfunction]
#[pyo3(signature = (x, y, gamma = 1.0, *, normalised = false))]
pub(crate) fn value(
    py: Python<'_>,
    x: &Bound<'_, PyAny>,
    y: &Bound<'_, PyAny>,
    gamma: f64,
    normalised: bool,
) -> PyResult<f64> {
    Ok(computed(py, [x, y], gamma, normalised, false)?.0)
}

/// Soft-DTW, and its gradient (n, components) with respect to `x`; see `value`.
#[pyfunction]
#[pyo3(signature = (x, y, gamma = 1.0, *, normalised = false))]
pub(crate) fn value_and_gradient(
    py: Python<'_>,
    x: &Bound<'_, PyAny>,
    y: &Bound<'_, PyAny>,
    gamma: f64,
    normalised: bool,
) -> PyResult<(f64, Py<PyAny>)> {
    computed(py, [x, y], gamma, normalised, true)
}

/// The value, and the gradient if it is asked for; `None` in Python otherwise.
fn computed(
    py: Python<'_>,
    [x, y]: [&Bound<'_, PyAny>; 2],
    gamma: f64,
    normalised: bool,
    with_gradient: bool,
) -> PyResult<(f64, Py<PyAny>)> {
    let dtw = SoftDtw::new(gamma).map_err(of_any)?;
    let (x, y) = (sequence(x, "x")?, sequence(y, "y")?);
    let components = x.shape()[1];
    in_dimension!(components, D => {
        let x = steps::<D>(&x, components, "x")?;
        let y = steps::<D>(&y, components, "y")?;
        let (x, y) = (&*x, &*y);
        ensure!(
            !with_gradient || x.len().saturating_mul(y.len()) <= MOST_CELLS,
            "a gradient of {} x {} steps exceeds the memory limit ({MOST_CELLS} cells of 24 bytes); use fewer steps",
            x.len(),
            y.len()
        );
        let computed = unlocked(py, x.len().saturating_mul(y.len()), || match (with_gradient, normalised) {
            (false, false) => dtw.value(x, y).map(|value| (value, None)),
            (false, true) => dtw.normalised(x, y).map(|value| (value, None)),
            (true, false) => dtw.value_and_gradient(x, y).map(|(value, gradient)| (value, Some(gradient))),
            (true, true) => dtw.normalised_and_gradient(x, y).map(|(value, gradient)| (value, Some(gradient))),
        });
        let (value, gradient) = computed.map_err(of_any)?;
        let Some(gradient) = gradient else {
            return Ok((value, py.None()));
        };
        let length = gradient.len();
        let flat = gradient.iter().flat_map(|step| &step[..components]).copied().collect();
        Ok((value, array(py, flat, [length, components])?))
    })
}

/// A search, ready to run without the GIL.
type SearchWork = Box<dyn FnOnce() -> Result<Vec<Vec<Neighbour>>, SearchError> + Send>;

/// The search for the `n` nearest of each query, for a number of components that is known at run time.
type Prepare = Box<dyn Fn(&[PyReadonlyArray2<'_, f64>], usize) -> PyResult<SearchWork> + Send + Sync>;

fn all_steps<const D: usize>(
    arrays: &[PyReadonlyArray2<'_, f64>],
    components: usize,
    name: &str,
) -> PyResult<Vec<Vec<[f64; D]>>> {
    let each = arrays.iter().enumerate().map(|(index, array)| {
        let name = format!("{name}[{index}]");
        Ok(steps::<D>(array, components, &name)?.into_owned())
    });
    each.collect()
}

fn sequences<'py>(objects: &[Bound<'py, PyAny>], name: &str) -> PyResult<Vec<PyReadonlyArray2<'py, f64>>> {
    (0_usize..).zip(objects).map(|(index, object)| sequence(object, &format!("{name}[{index}]"))).collect()
}

fn components_of(arrays: &[PyReadonlyArray2<'_, f64>], name: &str) -> PyResult<usize> {
    let first = arrays.first();
    Ok(first.ok_or_else(|| PyValueError::new_err(format!("{name} is empty; give at least one sequence")))?.shape()[1])
}

#[pyclass(frozen, module = "ddl_forecast._core")]
pub(crate) struct SearchIndex {
    prepare: Prepare,
    candidates: usize,
}

#[pymethods]
impl SearchIndex {
    #[new]
    #[pyo3(signature = (candidates, gamma = 1.0))]
    fn new(py: Python<'_>, candidates: Vec<Bound<'_, PyAny>>, gamma: f64) -> PyResult<Self> {
        let dtw = SoftDtw::new(gamma).map_err(of_any)?;
        let arrays = sequences(&candidates, "candidates")?;
        let components = components_of(&arrays, "candidates")?;
        let prepare: Prepare = in_dimension!(components, D => {
            let candidates = all_steps::<D>(&arrays, components, "candidates")?;
            let built = run(py, move |_| Index::build(&dtw, &candidates))?;
            let index = Arc::new(built.map_err(of_any)?);
            let prepare: Prepare = Box::new(move |queries, n| {
                let queries = all_steps::<D>(queries, components, "queries")?;
                let index = Arc::clone(&index);
                Ok(Box::new(move || index.nearest_batch(&queries, n)))
            });
            Ok(prepare)
        })?;
        Ok(Self { prepare, candidates: arrays.len() })
    }

    fn __len__(&self) -> usize {
        self.candidates
    }

    /// Indices `(q, n)` and distances `(q, n)`, nearest first.
    fn nearest(&self, py: Python<'_>, queries: Vec<Bound<'_, PyAny>>, n: usize) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
        let queries = sequences(&queries, "queries")?;
        let search = (self.prepare)(&queries, n)?;
        let neighbours = run(py, move |_| search())?.map_err(of_any)?;
        let shape = [neighbours.len(), n.min(self.candidates)];
        let flat = || neighbours.iter().flatten();
        let indices = flat().map(|neighbour| neighbour.index as i64).collect();
        let distances = flat().map(|neighbour| neighbour.distance).collect();
        Ok((array(py, indices, shape)?, array(py, distances, shape)?))
    }
}
