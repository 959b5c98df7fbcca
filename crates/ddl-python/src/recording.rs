//! Recordings: tracks of one place, from files or columns.

use crate::arrays::array;
use crate::errors::{ensure, of_any, parsed, raised};
use crate::interruptible::run;
use crate::moments::{UserMoments, clock_of_rate};
use ddl::data::{
    ColumnChoice, FRAME_LIMIT, Format, Homography, LiveError, LiveTracks, Observation, PedestrianId, PedestrianName,
    Recording as Tracks, RecordingError, TimeUnit, parse_columns, write_recording,
};
use ddl::{ObservedTracks, TimedRecording, TrackUnits};
use numpy::{PyReadonlyArray1, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::path::PathBuf;
use std::sync::Arc;

/// Tracks in metres.
#[pyclass(frozen, module = "ddl_forecast._core")]
#[derive(Debug, Clone)]
pub(crate) struct Recording {
    /// In ticks of the clock.
    pub(crate) tracks: Arc<Tracks>,
    /// With the frame numbers of the file, or its times in microseconds.
    rows: Arc<Tracks>,
    pub(crate) moments: UserMoments,
    /// Frame numbers per second, if the user or the file states them.
    fps: Option<f64>,
}

/// The rows on the clock of the rate that the user gives, or else the file.
fn on_clock(rows: Tracks, fps: Option<f64>, frame_step: Option<i64>) -> PyResult<Recording> {
    ensure!(
        fps.is_none() || frame_step.is_none(),
        "give fps or frame_step, not both: fps counts frames per second, frame_step frames in 0.4 s"
    );
    let unit = rows.time_unit();
    let is_given = fps.is_some() || frame_step.is_some();
    ensure!(
        unit.is_none() || !is_given,
        "the rows have times, and fps or frame_step gives a rate of frame numbers; leave it out"
    );
    // `TimedRecording` names seconds per frame in its error; this one names `fps`.
    fps.map(clock_of_rate).transpose()?;
    let given = TrackUnits { fps, frame_step, ..TrackUnits::default() };
    let timed = TimedRecording::new(&rows, &given, &TrackUnits::default()).map_err(raised)?;
    let stated = rows.stated_frame_time().filter(|_| !is_given).map(f64::recip);
    let notes = timed.notes.iter().map(ToString::to_string).collect();
    let (clock, tracks) = (timed.clock, Arc::new(timed.recording.with_notes(notes)));
    let is_same = unit.is_some() || clock.counts_frames();
    Ok(Recording {
        rows: if is_same { Arc::clone(&tracks) } else { Arc::new(rows) },
        tracks,
        moments: UserMoments { clock, unit },
        fps: fps.or(stated),
    })
}

/// What is doubtful or missing in the windows of a recording.
pub(crate) fn doubt(observed: &ObservedTracks) -> Option<String> {
    let doubts = observed.misfits().into_iter().chain(observed.never_forecast());
    let doubts: Vec<String> = doubts.map(|note| note.to_string()).collect();
    (!doubts.is_empty()).then(|| doubts.join("; "))
}

impl Recording {
    /// A recording whose frames are ticks.
    pub(crate) fn of_ticks(tracks: Tracks) -> Self {
        let tracks = Arc::new(tracks);
        Self { rows: Arc::clone(&tracks), tracks, moments: UserMoments::FRAMES, fps: None }
    }

    /// Windows of 8 observed steps, one for each moment with pedestrians to forecast.
    pub(crate) fn observed(&self, py: Python<'_>, live: LiveTracks, last: bool) -> PyResult<ObservedTracks> {
        let recording = (Arc::clone(&self.tracks), self.moments.clock);
        run(py, move |_| ObservedTracks::new(recording, live, last))
    }
}

#[pymethods]
impl Recording {
    #[new]
    fn new(
        frame: PyReadonlyArray1<'_, i64>,
        unit: Option<&str>,
        id: PyReadonlyArray1<'_, i64>,
        x: PyReadonlyArray1<'_, f64>,
        y: PyReadonlyArray1<'_, f64>,
        words: Option<Vec<String>>,
        fps: Option<f64>,
        frame_step: Option<i64>,
        name: &str,
    ) -> PyResult<Self> {
        let unit = unit.map(parsed).transpose()?;
        let lengths = [frame.len(), id.len(), x.len(), y.len()];
        ensure!(
            lengths.iter().all(|length| *length == lengths[0]),
            "{}, id, x and y must have one length; found {lengths:?} rows",
            if unit.is_some() { "time" } else { "frame" }
        );
        let [frame, id] = [frame.as_array(), id.as_array()];
        let [x, y] = [x.as_array(), y.as_array()];
        let mut observations = Vec::with_capacity(lengths[0]);
        for row in 0..lengths[0] {
            for (column, value) in [("x", x[row]), ("y", y[row])] {
                ensure!(
                    value.is_finite(),
                    "row {row}, column {column}: {value} is not a finite number in metres; leave out rows in which \
                         a pedestrian was not observed"
                );
            }
            let position = [x[row], y[row]];
            observations.push(Observation::new(frame[row], PedestrianId(id[row]), position));
        }
        let made = Tracks::in_usual_step(name, observations);
        let mut tracks = made.map_err(|error| match error {
            RecordingError::Row(LiveError::Duplicate { pedestrian, frame }) => {
                let words = words.as_ref();
                let word = words.and_then(|words| words.get((pedestrian.0 - FRAME_LIMIT) as usize));
                let pedestrian = word.map_or_else(|| pedestrian.to_string(), |word| format!("{word:?}"));
                let moment = unit.map_or(UserMoments::FRAMES, UserMoments::of_times).words(frame);
                PyValueError::new_err(format!("pedestrian {pedestrian} is in {moment} twice"))
            }
            error => of_any(error),
        })?;
        tracks = tracks.with_time_unit(unit);
        if let Some(words) = words {
            let numbered = (FRAME_LIMIT..).map(PedestrianId).zip(words.into_iter().map(Arc::from));
            tracks = tracks.with_words(numbered.collect());
        }
        on_clock(tracks, fps, frame_step)
    }

    #[staticmethod]
    #[pyo3(signature = (path, *, format = None, rate = (None, None), homography = None, choice = (None, None, None)))]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        format: Option<&str>,
        rate: (Option<f64>, Option<i64>),
        homography: Option<[[f64; 3]; 3]>,
        choice: (Option<String>, Option<String>, Option<String>),
    ) -> PyResult<Self> {
        let (fps, frame_step) = rate;
        let (columns, keep, unit) = &choice;
        let given = [columns, keep, unit].map(Option::as_deref);
        let choice = ColumnChoice::given(given, homography.is_some());
        let choice = choice.map_err(|error| PyValueError::new_err(error.to_string()))?;
        let bytes = std::fs::read(&path).map_err(|source| {
            let path = path.clone();
            raised(ddl::DdlError::Io { path, source })
        })?;
        let format = match format {
            Some(name) => parsed(name)?,
            None => Format::guess(&path, &bytes, &choice).map_err(of_any)?,
        };
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let read = py.detach(|| parse_columns(&bytes, &path.display().to_string(), format, &choice));
        let mut tracks = read.map_err(raised)?.with_name(&*name);
        if let Some(rows) = homography {
            let homography = Homography::try_from(rows).map_err(of_any)?;
            tracks = homography.to_ground(&tracks).map_err(of_any)?;
        }
        on_clock(tracks, fps, frame_step)
    }

    #[pyo3(signature = (path, *, format = "table"))]
    fn write(&self, path: PathBuf, format: &str) -> PyResult<()> {
        let bytes = write_recording(&self.rows, parsed(format)?).map_err(raised)?;
        ddl::write_atomically(&path, &bytes).map_err(raised)
    }

    /// What was assumed or left out by the reader, a sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.tracks.notes().to_vec()
    }

    #[getter]
    fn name(&self) -> &str {
        self.tracks.name()
    }

    #[getter]
    fn frame_step(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.moments.step(py)
    }

    #[getter]
    fn fps(&self) -> Option<f64> {
        self.fps
    }

    /// What its times count; `None` for frame numbers.
    #[getter]
    fn unit(&self) -> Option<&'static str> {
        self.moments.unit.map(TimeUnit::name)
    }

    fn __len__(&self) -> usize {
        self.tracks.observations().len()
    }

    fn __repr__(&self) -> String {
        format!(
            "Recording({:?}, {} pedestrians, {} frames, {} positions)",
            self.name(),
            self.tracks.pedestrians().len(),
            self.tracks.frames().len(),
            self.__len__()
        )
    }

    /// The frame of every position as a whole number, or its time in microseconds.
    fn numbers(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let frames = self.rows.observations().iter().map(|row| row.frame);
        array(py, frames.collect(), [self.__len__()])
    }

    /// Frame, id, x and y of every position, in order of frames; frames or times as in the file, ids as a list if some
    /// are words.
    fn columns(&self, py: Python<'_>) -> PyResult<(Py<PyAny>, Py<PyAny>, Py<PyAny>, Py<PyAny>)> {
        let observations = self.tracks.observations();
        let n = observations.len();
        let frames = observations.iter().map(|seen| seen.frame);
        let frame = self.moments.all(py, frames.collect())?;
        let axis = |axis: usize| array(py, observations.iter().map(|seen| seen.position[axis]).collect(), [n]);
        let names = self.tracks.names();
        let numbered = observations.iter().map(|seen| match names.of(seen.pedestrian) {
            PedestrianName::Number(number) => Some(number),
            PedestrianName::Word(_) => None,
        });
        let id = if let Some(numbers) = numbered.collect::<Option<Vec<i64>>>() {
            array(py, numbers, [n])?
        } else {
            let words = observations.iter().map(|seen| names.of(seen.pedestrian).to_string());
            PyList::new(py, words)?.into_any().unbind()
        };
        Ok((frame, id, axis(0)?, axis(1)?))
    }

    /// Text that describes a fault suggested by the speeds.
    fn doubt(&self) -> Option<String> {
        Some(ddl::in_frames(self.moments.clock, self.tracks.speed_warning()?).to_string())
    }
}
