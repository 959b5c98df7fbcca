//! Live forecasts of an observed place.

use crate::arrays::points;
use crate::errors::raised;
use crate::forecasts::{PlainOrCertified, named_parts};
use crate::interruptible::{run_live, wait_for};
use crate::model::Model;
use crate::observed::completion;
use ddl::data::{LiveTracks, PedestrianId, Position, Window, whole_frame_step};
use ddl::{AdaptiveRegions, Ddl, DdlError, LiveForecaster, MemoryFile};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

#[pyclass(frozen, module = "ddl_forecast._core")]
pub(crate) struct Live(SharedPlace);

/// `None` while a call uses the state. No lock is held during a forecast, so a worker thread never waits for its own
/// lock.
type SharedPlace = Arc<Mutex<Option<Box<WatchedPlace>>>>;

struct WatchedPlace {
    live: LiveForecaster<Arc<Ddl>>,
    file: Option<MemoryFile>,
    certificates: bool,
}

/// The answer to a frame: a forecast if there are pedestrians to forecast, and an error if the memory could not be
/// written.
type Answer = (Option<(Window, PlainOrCertified)>, Option<String>);

impl WatchedPlace {
    fn observe(&mut self, frame: i64, seen: Vec<(PedestrianId, Position)>) -> Result<Answer, DdlError> {
        let forecast = if self.certificates {
            let now = self.live.push_certified(frame, seen)?;
            now.map(|now| (now.window, PlainOrCertified::Certified(now.forecast)))
        } else {
            let now = self.live.push(frame, seen)?;
            now.map(|now| (now.window, PlainOrCertified::Plain(now.forecast)))
        };
        let mut unwritten = None;
        if let (Some(file), Some(place)) = (&mut self.file, self.live.place())
            && file.is_due()
        {
            // The frame has been observed, so a full disk must not discard its forecast.
            unwritten = file.write(place).err().map(|error| error.to_string());
        }
        Ok((forecast, unwritten))
    }

    /// Writes the memory; on success, closes its file.
    fn close(&mut self) -> Result<Option<String>, DdlError> {
        let warning = match (&mut self.file, self.live.place()) {
            (Some(file), Some(place)) => file.end(place.clone())?,
            _ => None,
        };
        self.file = None;
        Ok(warning)
    }
}

/// Exclusive use of the state. Dropping it returns the state, even after a panic or an interrupted call.
struct Turn {
    slot: SharedPlace,
    watching: Option<Box<WatchedPlace>>,
}

impl Turn {
    /// Waits until other calls have returned the state.
    fn take(py: Python<'_>, slot: &SharedPlace) -> PyResult<Self> {
        let watching = wait_for(py, || held(slot).take())?;
        Ok(Self {
            slot: Arc::clone(slot),
            watching: Some(watching),
        })
    }

    /// Never `None`: the state is present until this is dropped.
    fn watching(&mut self) -> Option<&mut WatchedPlace> {
        self.watching.as_deref_mut()
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        *held(&self.slot) = self.watching.take();
    }
}

fn held(slot: &SharedPlace) -> MutexGuard<'_, Option<Box<WatchedPlace>>> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

#[pymethods]
impl Live {
    #[new]
    #[pyo3(signature = (model, fps, memory, whole, certificates))]
    fn new(model: &Model, fps: f64, memory: Option<PathBuf>, whole: bool, certificates: bool) -> PyResult<Self> {
        let step = if fps.is_finite() && fps > 0.0 {
            whole_frame_step(fps.recip())
        } else {
            None
        };
        let step = step.ok_or_else(|| {
            PyValueError::new_err(format!(
            "fps is {fps}: it must be the frames per second, and 0.4 s must be a whole number of frames, as for 2.5, \
             5, 10, 12.5 or 25; live tracks are not resampled"
            ))
        })?;
        let tracks = LiveTracks::with_frame_step(step).map_err(|error| raised(DdlError::from(error)))?;
        let tracks = tracks.with_completion(completion(whole));
        let live = LiveForecaster::with_tracks(Arc::clone(&model.0), tracks);
        let mut live = live.with_adaptive_regions(AdaptiveRegions::default());
        let mut file = None;
        if let Some(path) = memory {
            let (opened, read) = MemoryFile::open(&path).map_err(raised)?;
            live = live.remembering(read).map_err(raised)?;
            file = Some(opened);
        }
        let watching = WatchedPlace {
            live,
            file,
            certificates,
        };
        Ok(Self(Arc::new(Mutex::new(Some(Box::new(watching))))))
    }

    /// A forecast (`None` without pedestrians to forecast), and an error if the memory could not be written.
    fn observe<'py>(
        &self,
        py: Python<'py>,
        frame: i64,
        ids: PyReadonlyArray1<'py, i64>,
        xy: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<(Option<Bound<'py, PyDict>>, Option<String>)> {
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
        let mut turn = Turn::take(py, &self.0)?;
        let now = run_live(py, move |_| {
            let watching = turn.watching();
            watching.map(|watching| watching.observe(frame, seen))
        })?;
        let Some((forecast, unwritten)) = now.transpose().map_err(raised)? else {
            return Ok((None, None));
        };
        let parts = forecast.map(|(window, forecast)| named_parts(py, &window, &forecast, 1));
        Ok((parts.transpose()?, unwritten))
    }

    /// Forgets all tracks; the memory is kept.
    fn clear(&self, py: Python<'_>) -> PyResult<()> {
        let mut turn = Turn::take(py, &self.0)?;
        if let Some(watching) = turn.watching() {
            watching.live.clear();
        }
        Ok(())
    }

    /// Number of remembered segments; 0 without a memory.
    fn remembered(&self, py: Python<'_>) -> PyResult<usize> {
        let mut turn = Turn::take(py, &self.0)?;
        let place = turn.watching().and_then(|watching| watching.live.place());
        Ok(place.map_or(0, |place| place.memory().segments()))
    }

    /// The reason why the given memory is not used; `None` if it is used.
    fn refused(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let mut turn = Turn::take(py, &self.0)?;
        let refused = turn.watching().and_then(|watching| watching.live.place()?.refused());
        Ok(refused.map(str::to_owned))
    }

    /// Writes the memory and closes its file; returns a warning, if any.
    fn close(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let mut turn = Turn::take(py, &self.0)?;
        let warning = run_live(py, move |_| turn.watching().map_or(Ok(None), WatchedPlace::close))?;
        warning.map_err(raised)
    }
}
