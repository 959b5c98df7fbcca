//! Forecasts of a place that is watched, frame by frame.

use crate::arrays::points;
use crate::errors::raised;
use crate::forecasts::{Forecasted, named_parts};
use crate::interruptible::run;
use crate::model::Model;
use crate::observed::completion;
use ddl::data::{PedestrianId, Position, Window, whole_frame_step};
use ddl::eval::AdaptiveRegions;
use ddl::memory::SceneMemory;
use ddl::{Ddl, DdlError, LiveForecaster, MemoryFile};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

#[pyclass(frozen, module = "ddl_forecast._core")]
pub(crate) struct Live(Arc<Mutex<Watching>>);

struct Watching {
    live: LiveForecaster<Arc<Ddl>>,
    file: Option<MemoryFile>,
    certificates: bool,
}

impl Watching {
    fn observe(
        &mut self,
        frame: i64,
        seen: Vec<(PedestrianId, Position)>,
    ) -> Result<Option<(Window, Forecasted)>, DdlError> {
        let forecast = if self.certificates {
            let now = self.live.push_certified(frame, seen)?;
            now.map(|now| (now.window, Forecasted::Certified(now.forecast)))
        } else {
            let now = self.live.push(frame, seen)?;
            now.map(|now| (now.window, Forecasted::Plain(now.forecast)))
        };
        if let (Some(file), Some(place)) = (&mut self.file, self.live.place())
            && file.is_due()
        {
            file.write(place)?;
        }
        Ok(forecast)
    }
}

#[pymethods]
impl Live {
    #[new]
    #[pyo3(signature = (model, fps, memory, whole, certificates))]
    fn new(
        model: &Model,
        fps: f64,
        memory: Option<PathBuf>,
        whole: bool,
        certificates: bool,
    ) -> PyResult<Self> {
        let step = if fps.is_finite() && fps > 0.0 {
            whole_frame_step(fps.recip())
        } else {
            None
        };
        let step = step.ok_or_else(|| {
            PyValueError::new_err(format!(
                "fps is {fps}: it must be the frames in a second, of which 0.4 s are a whole number, such as 2.5, 5, 10, 12.5 or 25; live \
                 tracks are not resampled"
            ))
        })?;
        let live = LiveForecaster::with_frame_step(Arc::clone(&model.0), step).map_err(raised)?;
        let mut live = live
            .completing(completion(whole))
            .adapting_regions(AdaptiveRegions::default());
        let mut file = None;
        if let Some(path) = memory {
            let (opened, read) = MemoryFile::open(&path).map_err(raised)?;
            let memory = match read {
                Some(memory) => memory,
                None => SceneMemory::new(step, SceneMemory::DEFAULT_CAPACITY)
                    .map_err(|error| raised(DdlError::from(error)))?,
            };
            live = live.remembering(memory).map_err(raised)?;
            file = Some(opened);
        }
        Ok(Self(Arc::new(Mutex::new(Watching {
            live,
            file,
            certificates,
        }))))
    }

    /// A forecast, or nothing while nobody has been seen often enough.
    fn observe<'py>(
        &self,
        py: Python<'py>,
        frame: i64,
        ids: PyReadonlyArray1<'py, i64>,
        xy: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Option<Bound<'py, PyDict>>> {
        let positions = points("xy", &xy)?;
        if ids.len() != positions.len() {
            return Err(PyValueError::new_err(format!(
                "{} ids but {} positions; give one position for each id",
                ids.len(),
                positions.len()
            )));
        }
        let seen = ids.as_array().into_iter().map(|id| PedestrianId(*id));
        let seen: Vec<_> = seen.zip(positions).collect();
        let watching = Arc::clone(&self.0);
        let now = run(py, move |_| lock(&watching).observe(frame, seen))?;
        let Some((window, forecast)) = now.map_err(raised)? else {
            return Ok(None);
        };
        named_parts(py, &window, &forecast, 1).map(Some)
    }

    /// Forgets who is there; the memory stays.
    fn clear(&self) {
        lock(&self.0).live.clear();
    }

    /// Earlier stretches that are remembered; 0 without a memory.
    fn remembered(&self) -> usize {
        let watching = lock(&self.0);
        watching.live.memory().map_or(0, SceneMemory::stretches)
    }

    /// Why the memory that was given is not used, if it is not.
    fn refused(&self) -> Option<String> {
        let watching = lock(&self.0);
        watching.live.refused_memory().map(ToString::to_string)
    }

    /// Writes the memory and lets go of its file; what is to be told, if anything.
    fn close(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let watching = Arc::clone(&self.0);
        let told = run(py, move |_| {
            let mut watching = lock(&watching);
            let Some(mut file) = watching.file.take() else {
                return Ok(None);
            };
            watching.live.end_trial();
            match watching.live.place() {
                Some(place) => file.end(place),
                None => Ok(None),
            }
        })?;
        told.map_err(raised)
    }
}

/// A forecaster is whole after every call, also after a panic.
fn lock(watching: &Mutex<Watching>) -> std::sync::MutexGuard<'_, Watching> {
    watching.lock().unwrap_or_else(PoisonError::into_inner)
}
