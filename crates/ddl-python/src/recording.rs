//! Recordings: tracks of one place, from files or columns.

use crate::arrays::array;
use crate::errors::{of_any, raised};
use crate::observed::completion;
use ddl::data::{
    Format, Homography, Observation, PedestrianId, PedestrianName, Recording as Tracks, RecordingError, Window,
    read_recording, write_recording,
};
use numpy::{PyReadonlyArray1, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::path::PathBuf;
use std::sync::Arc;

/// Tracks in metres, in steps of 0.4 s.
#[pyclass(frozen, module = "ddl_forecast._core")]
#[derive(Debug, Clone)]
pub(crate) struct Recording {
    pub(crate) tracks: Arc<Tracks>,
    /// Number of its frames per frame of the file; above 1 if 0.4 s is not a whole number of frames.
    pub(crate) parts: i64,
}

/// The frame rate, if the user gives it.
#[derive(Debug, Clone, Copy)]
struct GivenRate {
    fps: Option<f64>,
    frame_step: Option<i64>,
}

impl GivenRate {
    fn of(self, tracks: Tracks) -> PyResult<Recording> {
        if self.fps.is_some() && self.frame_step.is_some() {
            return Err(PyValueError::new_err(
                "give fps or frame_step, not both: fps counts frames per second, frame_step frames in 0.4 s",
            ));
        }
        if let Some(step) = self.frame_step {
            let tracks = tracks.with_frame_step(step).map_err(of_any)?;
            return Ok(Recording::whole(tracks));
        }
        if let Some(fps) = self.fps
            && !(fps.is_finite() && fps > 0.0)
        {
            return Err(PyValueError::new_err(format!(
                "fps must be a finite number above 0, the frames per second; found {fps}"
            )));
        }
        let Some(frame_time) = self.fps.map(f64::recip).or(tracks.stated_frame_time()) else {
            return Ok(Recording::whole(tracks));
        };
        let steps = tracks.resampled_to_steps(frame_time).map_err(of_any)?;
        Ok(Recording {
            tracks: Arc::new(steps.recording),
            parts: steps.parts,
        })
    }
}

impl Recording {
    fn whole(tracks: Tracks) -> Self {
        let tracks = Arc::new(tracks);
        Self { tracks, parts: 1 }
    }

    /// Windows of 8 observed steps, one for each frame with pedestrians to forecast.
    pub(crate) fn observed(&self, whole: bool) -> Vec<Window> {
        self.tracks.completed_windows(completion(whole))
    }
}

#[pymethods]
impl Recording {
    #[new]
    #[pyo3(signature = (frame, id, x, y, words, fps, frame_step, name))]
    fn new(
        frame: PyReadonlyArray1<'_, i64>,
        id: PyReadonlyArray1<'_, i64>,
        x: PyReadonlyArray1<'_, f64>,
        y: PyReadonlyArray1<'_, f64>,
        words: Option<Vec<String>>,
        fps: Option<f64>,
        frame_step: Option<i64>,
        name: &str,
    ) -> PyResult<Self> {
        let lengths = [frame.len(), id.len(), x.len(), y.len()];
        if lengths.iter().any(|length| *length != lengths[0]) {
            return Err(PyValueError::new_err(format!(
                "frame, id, x and y must have one length; found {lengths:?} rows"
            )));
        }
        let [frame, id] = [frame.as_array(), id.as_array()];
        let [x, y] = [x.as_array(), y.as_array()];
        let mut observations = Vec::with_capacity(lengths[0]);
        for row in 0..lengths[0] {
            for (column, value) in [("x", x[row]), ("y", y[row])] {
                if !value.is_finite() {
                    return Err(PyValueError::new_err(format!(
                        "row {row}, column {column}: {value} is not a finite number in metres; leave out rows in which \
                         a pedestrian was not observed"
                    )));
                }
            }
            let position = [x[row], y[row]];
            observations.push(Observation::new(frame[row], PedestrianId(id[row]), position));
        }
        let made = Tracks::in_usual_step(name, observations);
        let mut tracks = made.map_err(|error| match (&error, &words) {
            (RecordingError::Duplicate { pedestrian, frame }, Some(words)) => {
                let word = words.get(pedestrian.0 as usize).map_or("", String::as_str);
                PyValueError::new_err(format!("pedestrian {word:?} is in frame {frame} twice"))
            }
            _ => of_any(error),
        })?;
        if let Some(words) = words {
            let numbered = (0..).map(PedestrianId).zip(words.into_iter().map(Arc::from));
            tracks = tracks.with_words(numbered.collect());
        }
        GivenRate { fps, frame_step }.of(tracks)
    }

    #[staticmethod]
    #[pyo3(signature = (path, *, format = None, fps = None, frame_step = None, homography = None))]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        format: Option<&str>,
        fps: Option<f64>,
        frame_step: Option<i64>,
        homography: Option<[[f64; 3]; 3]>,
    ) -> PyResult<Self> {
        let format = if let Some(name) = format {
            format_named(name)?
        } else {
            let bytes = std::fs::read(&path).map_err(|source| {
                let path = path.clone();
                raised(ddl::DdlError::Io { path, source })
            })?;
            Format::guess(&path, &bytes)
        };
        let mut tracks = py.detach(|| read_recording(&path, format)).map_err(raised)?;
        if let Some(rows) = homography {
            let homography = Homography::try_from(rows).map_err(of_any)?;
            tracks = homography.to_ground(&tracks).map_err(of_any)?;
        }
        GivenRate { fps, frame_step }.of(tracks)
    }

    #[pyo3(signature = (path, *, format = "table"))]
    fn write(&self, path: PathBuf, format: &str) -> PyResult<()> {
        if self.parts != 1 {
            return Err(PyValueError::new_err(
                "the positions were resampled to steps of 0.4 s between the frames; to write the recording, read it \
                 without fps",
            ));
        }
        let bytes = write_recording(&self.tracks, format_named(format)?).map_err(raised)?;
        ddl::write_atomically(&path, &bytes).map_err(raised)
    }

    #[getter]
    fn name(&self) -> &str {
        self.tracks.name()
    }

    #[getter]
    fn frame_step(&self) -> f64 {
        self.tracks.frame_step() as f64 / self.parts as f64
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

    /// Frame, id, x and y of every position, in order of frames; frames as in the file, ids as a list if some are
    /// words.
    fn columns(&self, py: Python<'_>) -> PyResult<(Py<PyAny>, Py<PyAny>, Py<PyAny>, Py<PyAny>)> {
        let observations = self.tracks.observations();
        let n = observations.len();
        let frame = if self.parts == 1 {
            array(py, observations.iter().map(|seen| seen.frame).collect(), [n])?
        } else {
            let parts = self.parts as f64;
            let frames = observations.iter().map(|seen| seen.frame as f64 / parts);
            array(py, frames.collect(), [n])?
        };
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
        Some(self.tracks.speed_warning()?.to_string())
    }
}

pub(crate) fn format_named(name: &str) -> PyResult<Format> {
    let format = Format::ALL.into_iter().find(|format| format.name() == name);
    format.ok_or_else(|| {
        PyValueError::new_err(format!(
            "format must be one of {}; found {name:?}",
            Format::ALL.map(Format::name).join(", ")
        ))
    })
}
