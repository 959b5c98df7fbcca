//! Live forecasts of an observed place.

use crate::arrays::points;
use crate::errors::{ensure, of_any, parsed, raised};
use crate::forecasts::named_parts;
use crate::interruptible::{User, run_on, wait_for};
use crate::model::ForecastModel;
use crate::moments::{UserMoments, clock_of_rate};
use ddl::data::{Clock, LiveError, LiveTracks, PedestrianId, PedestrianNames, TimeUnit};
use ddl::{Ddl, DdlError, Note, Request, Session, SessionMemory, WindowOptions};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

#[pyclass(frozen, name = "Live", module = "ddl_forecast._core")]
pub(crate) struct LiveHandle {
    session: SharedSession,
    clock: Clock,
}

/// `None` while a call uses the state. No lock is held during a forecast, so a worker thread never waits for its own
/// lock.
type SharedSession = Arc<Mutex<Option<Box<Session<Arc<Ddl>>>>>>;

/// Exclusive use of the state. Dropping it returns the state, even after a panic or an interrupted call.
struct SessionTurn {
    slot: SharedSession,
    session: Option<Box<Session<Arc<Ddl>>>>,
}

impl SessionTurn {
    /// Waits until other calls have returned the state.
    fn take(py: Python<'_>, slot: &SharedSession) -> PyResult<Self> {
        let session = wait_for(py, || held(slot).take())?;
        Ok(Self { slot: Arc::clone(slot), session: Some(session) })
    }

    /// Never `None`: the state is present until this is dropped.
    fn session(&mut self) -> Option<&mut Session<Arc<Ddl>>> {
        self.session.as_deref_mut()
    }
}

impl Drop for SessionTurn {
    fn drop(&mut self) {
        *held(&self.slot) = self.session.take();
    }
}

fn held(slot: &SharedSession) -> MutexGuard<'_, Option<Box<Session<Arc<Ddl>>>>> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

#[pymethods]
impl LiveHandle {
    #[new]
    fn new(
        model: &ForecastModel,
        fps: Option<f64>,
        memory: Option<PathBuf>,
        whole: bool,
        max_age: Option<f64>,
        every: f64,
        certificates: bool,
        joint: bool,
    ) -> PyResult<Self> {
        let clock = match fps {
            Some(fps) => clock_of_rate(fps)?,
            None => Clock::with_stamps(TimeUnit::Seconds),
        };
        let tracks = WindowOptions { whole, max_age, every: Some(every), last: false };
        let tracks = tracks.tracks(LiveTracks::with_clock(clock)).map_err(of_any)?;
        let request = if joint { Request::joint() } else { Request::default() };
        let request = if certificates { request.with_certificates() } else { request };
        let session = Session::new(Arc::clone(&model.0), tracks, request.with_adaptive_regions());
        let mut session = session.map_err(raised)?;
        if let Some(path) = memory {
            let memory = SessionMemory::in_file(&path);
            session = memory.and_then(|memory| session.remembering(memory)).map_err(raised)?;
        }
        Ok(Self { session: Arc::new(Mutex::new(Some(Box::new(session)))), clock })
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
            Some(unit) => UserMoments::of_times(parsed(unit)?),
            None => UserMoments { clock: self.clock, unit: None },
        };
        let positions = points("xy", &xy)?;
        ensure!(
            ids.len() == positions.len(),
            "{} ids but {} positions; give one position for each id",
            ids.len(),
            positions.len()
        );
        let seen: Vec<_> = ids.as_array().into_iter().map(|id| PedestrianId(*id)).zip(positions).collect();
        let words = words.into_iter().map(|(id, word)| (PedestrianId(id), word.into()));
        let names = PedestrianNames::new(words.collect());
        let of_frame = names.clone();
        let mut turn = SessionTurn::take(py, &self.session)?;
        let observe = move |_: &_| turn.session().map(|session| session.push_named(frame, seen, &of_frame));
        let now = run_on(User::Live, py, observe, |_| Ok(()))?;
        let Some(now) = now.transpose().map_err(|error| wrong_frame(error, moments, &names))? else {
            return Ok((None, Vec::new(), None));
        };
        let parts = now.answer.map(|(window, answer)| named_parts(py, &window, &answer, moments));
        let misfits = now.notes.iter().flat_map(Note::misfits);
        let misfits = misfits.map(|noted| (noted.misfit.pedestrian.0, noted.misfit.distance, noted.when.clone()));
        let unwritten = now.notes.iter().find_map(|note| match note {
            Note::MemoryUnwritten(error) => Some(error.to_string()),
            _ => None,
        });
        Ok((parts.transpose()?, misfits.collect(), unwritten))
    }

    /// Forgets all tracks; the memory is kept.
    fn clear(&self, py: Python<'_>) -> PyResult<()> {
        let mut turn = SessionTurn::take(py, &self.session)?;
        if let Some(session) = turn.session() {
            session.clear(None);
        }
        Ok(())
    }

    /// Number of remembered segments; 0 without a memory.
    fn remembered(&self, py: Python<'_>) -> PyResult<usize> {
        let mut turn = SessionTurn::take(py, &self.session)?;
        let place = turn.session().and_then(|session| session.place(None));
        Ok(place.map_or(0, |place| place.memory().segments()))
    }

    /// The reason why the given memory is not used; `None` if it is used.
    fn refused(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let mut turn = SessionTurn::take(py, &self.session)?;
        Ok(turn.session().and_then(|session| session.place(None)?.refused()).map(|refusal| refusal.to_string()))
    }

    /// Writes the memory and closes its file; returns a warning, if any.
    fn close(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let mut turn = SessionTurn::take(py, &self.session)?;
        let close = move |_: &_| turn.session().map(Session::close).unwrap_or_default();
        match run_on(User::Live, py, close, |_| Ok(()))?.pop() {
            Some(Note::MemoryFailed(error)) => Err(Arc::try_unwrap(error).map_or_else(of_any, raised)),
            Some(Note::MemoryUnsaved { unsaved, .. }) => Ok(Some(unsaved.to_string())),
            _ => Ok(None),
        }
    }
}

/// The error with frame numbers or times as the user counts them.
fn wrong_frame(error: DdlError, moments: UserMoments, names: &PedestrianNames) -> PyErr {
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
