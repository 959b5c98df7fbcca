//! Live forecasts of an observed place.

use crate::arrays::points;
use crate::errors::{ensure, of_any, parsed, raised};
use crate::forecasts::named_parts;
use crate::interruptible::{User, run_on, wait_for};
use crate::model::Model;
use crate::moments::{Moments, clock_of_rate};
use ddl::data::{Clock, LiveError, LiveTracks, PedestrianId, PedestrianNames, Position, TimeUnit, Window};
use ddl::{AdaptiveRegions, CertifiedForecast, Ddl, DdlError, LiveForecaster, MemoryFile};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

#[pyclass(frozen, module = "ddl_forecast._core")]
pub(crate) struct Live {
    place: SharedPlace,
    clock: Clock,
}

/// `None` while a call uses the state. No lock is held during a forecast, so a worker thread never waits for its own
/// lock.
type SharedPlace = Arc<Mutex<Option<Box<WatchedPlace>>>>;

struct WatchedPlace {
    live: LiveForecaster<Arc<Ddl>>,
    file: Option<MemoryFile>,
    certificates: bool,
    joint: bool,
}

/// The answer to a frame.
struct Answer {
    /// `None` without pedestrians to forecast.
    forecast: Option<(Window, CertifiedForecast)>,
    /// The pedestrians whose position does not fit their track, with its distance (m) from where it was expected.
    misfits: Vec<(i64, f64, String)>,
    /// An error if the memory could not be written.
    unwritten: Option<String>,
}

impl WatchedPlace {
    fn observe(&mut self, frame: i64, seen: Vec<(PedestrianId, Position)>) -> Result<Answer, DdlError> {
        let forecast = if self.joint {
            self.live.push_joint(frame, seen, None)?.map(|now| (now.window, now.forecast.into()))
        } else if self.certificates {
            self.live.push_certified(frame, seen)?.map(|now| (now.window, now.forecast))
        } else {
            self.live.push(frame, seen)?.map(|now| (now.window, now.forecast.into()))
        };
        // The frame has been observed, so a full disk must not discard its forecast.
        let written = MemoryFile::write_if_due(self.file.as_mut(), self.live.place());
        let unwritten = written.err().map(|error| error.to_string());
        let tracks = self.live.tracks();
        let misfits = tracks.misfits().iter();
        let misfits = misfits.map(|misfit| {
            let when = tracks.clock().words(misfit.tick);
            (misfit.pedestrian.0, misfit.distance, when)
        });
        Ok(Answer { forecast, misfits: misfits.collect(), unwritten })
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
        Ok(Self { slot: Arc::clone(slot), watching: Some(watching) })
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
    fn new(
        model: &Model,
        fps: Option<f64>,
        memory: Option<PathBuf>,
        whole: bool,
        max_age: Option<f64>,
        every: f64,
        certificates: bool,
        joint: bool,
    ) -> PyResult<Self> {
        ensure!(
            !(joint && certificates),
            "live joint futures have no certificates: leave out one of joint and certificates"
        );
        let clock = match fps {
            Some(fps) => clock_of_rate(fps)?,
            None => Clock::with_stamps(TimeUnit::Seconds),
        };
        let tracks = ddl::windows_of(LiveTracks::with_clock(clock), whole, [max_age, Some(every)], false);
        let tracks = tracks.map_err(PyValueError::new_err)?;
        let live = LiveForecaster::with_tracks(Arc::clone(&model.0), tracks);
        let mut live = live.with_adaptive_regions(AdaptiveRegions::default());
        let mut file = None;
        if let Some(path) = memory {
            let (opened, read) = MemoryFile::open(&path).map_err(raised)?;
            live = live.remembering(read).map_err(raised)?;
            file = Some(opened);
        }
        let watching = WatchedPlace { live, file, certificates, joint };
        let place = Arc::new(Mutex::new(Some(Box::new(watching))));
        Ok(Self { place, clock })
    }

    /// A forecast (`None` without pedestrians to forecast), the pedestrians whose positions do not fit, each with its
    /// distance from where it was expected, and an error if the memory could not be written. With a unit, `frame` is a
    /// time in microseconds. `words` are the names of ids.
    fn observe<'py>(
        &self,
        py: Python<'py>,
        frame: i64,
        unit: Option<&str>,
        ids: PyReadonlyArray1<'py, i64>,
        xy: PyReadonlyArray2<'py, f64>,
        words: BTreeMap<i64, String>,
    ) -> PyResult<(Option<Bound<'py, PyDict>>, Vec<(i64, f64, String)>, Option<String>)> {
        let moments = match unit {
            Some(unit) => Moments::of_times(parsed(unit)?),
            None => Moments { clock: self.clock, unit: None },
        };
        let positions = points("xy", &xy)?;
        ensure!(
            ids.len() == positions.len(),
            "{} ids but {} positions; give one position for each id",
            ids.len(),
            positions.len()
        );
        let seen = ids.as_array().into_iter().map(|id| PedestrianId(*id));
        let seen: Vec<_> = seen.zip(positions).collect();
        let words = words.into_iter().map(|(id, word)| (PedestrianId(id), word.into()));
        let names = PedestrianNames::new(words.collect());
        let of_frame = names.clone();
        let mut turn = Turn::take(py, &self.place)?;
        let observe = move |_: &_| {
            let watching = turn.watching()?;
            watching.live.name(&of_frame);
            Some(watching.observe(frame, seen))
        };
        let now = run_on(User::Live, py, observe, |_| Ok(()))?;
        let Some(answer) = now.transpose().map_err(|error| wrong_frame(error, moments, &names))? else {
            return Ok((None, Vec::new(), None));
        };
        let parts = answer.forecast.map(|(window, forecast)| named_parts(py, &window, &forecast, moments));
        Ok((parts.transpose()?, answer.misfits, answer.unwritten))
    }

    /// Forgets all tracks; the memory is kept.
    fn clear(&self, py: Python<'_>) -> PyResult<()> {
        let mut turn = Turn::take(py, &self.place)?;
        if let Some(watching) = turn.watching() {
            watching.live.clear();
        }
        Ok(())
    }

    /// Number of remembered segments; 0 without a memory.
    fn remembered(&self, py: Python<'_>) -> PyResult<usize> {
        let mut turn = Turn::take(py, &self.place)?;
        let place = turn.watching().and_then(|watching| watching.live.place());
        Ok(place.map_or(0, |place| place.memory().segments()))
    }

    /// The reason why the given memory is not used; `None` if it is used.
    fn refused(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let mut turn = Turn::take(py, &self.place)?;
        let refused = turn.watching().and_then(|watching| watching.live.place()?.refused());
        Ok(refused.map(str::to_owned))
    }

    /// Writes the memory and closes its file; returns a warning, if any.
    fn close(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let mut turn = Turn::take(py, &self.place)?;
        let close = move |_: &_| turn.watching().map_or(Ok(None), WatchedPlace::close);
        let warning = run_on(User::Live, py, close, |_| Ok(()))?;
        warning.map_err(raised)
    }
}

/// The error with frame numbers or times as the user counts them.
fn wrong_frame(error: DdlError, moments: Moments, names: &PedestrianNames) -> PyErr {
    let DdlError::Live(error) = error else {
        return raised(error);
    };
    // Frames and times are as they were given.
    let words = |frame| moments.words(moments.clock.tick(frame).unwrap_or(frame));
    PyValueError::new_err(match error {
        LiveError::TooEarly { frame, last } => format!(
            "{} comes after {}; give frames in order of time, each once; when the tracker restarts, call clear()",
            words(frame),
            words(last)
        ),
        LiveError::Duplicate { pedestrian, frame } => {
            let (name, frame) = (names.of(pedestrian), words(frame));
            format!("pedestrian {name} is in {frame} twice; keep one position")
        }
        error => return of_any(error),
    })
}
