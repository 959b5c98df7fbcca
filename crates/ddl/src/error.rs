//! The errors of the crate.

use ddl_core::Setting;
use std::path::{Path, PathBuf};

/// An error and its causes, each once.
pub fn with_causes(error: &dyn std::error::Error) -> String {
    let mut words = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        if !words.contains(&error.to_string()) {
            words = format!("{words}: {error}");
        }
        cause = error.source();
    }
    words
}

/// Errors of `ddl`. A message states the fault, its place and the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum DdlError {
    #[cfg(feature = "files")]
    #[error(transparent)]
    Data(#[from] ddl_data::DataError),
    #[error(transparent)]
    Live(#[from] ddl_data::LiveError),
    #[error(transparent)]
    Clock(#[from] ddl_data::ClockError),
    #[error("the rows have times, and {given} gives a rate: leave it out")]
    Rate { given: String },
    #[error(transparent)]
    Windows(#[from] crate::tracks::windows::OutOfGap),
    #[error(
        "the moment is {at}; it must be a number of seconds below 9e9, or with {} a frame number below 2^53",
        Setting::Fps
    )]
    Moment { at: f64 },
    #[error("at {at}{}: {error}", if *.is_time { " s (frames are microseconds)" } else { "" })]
    At { at: f64, is_time: bool, error: Box<Self> },
    #[error("{}", memory_of_scenes(path, *.is_folder))]
    MemoryOfScenes { path: PathBuf, is_folder: bool },
    #[error(
        "another scene would be more than {limit}; a scene is forgotten when no frame of it has come for {minutes} \
         minutes: \
         watch the others in another process"
    )]
    TooManyScenes { limit: usize, minutes: u64 },
    #[error(
        "{limit} frames wait to be forecast from; forecast some before the next is observed, or keep the latest of \
         each scene alone"
    )]
    TooManyWaiting { limit: usize },
    #[error("{0} threads are more than 1024; without a number there is one for each core")]
    Threads(usize),
    #[error("threads cannot be started: {0}")]
    ThreadPool(#[from] rayon::ThreadPoolBuildError),
    #[error(transparent)]
    Memory(#[from] ddl_memory::MemoryError),
    #[error(transparent)]
    Goal(#[from] ddl_goal::GoalError),
    #[error(transparent)]
    GoalParameters(#[from] ddl_goal::ParamsError),
    #[error(transparent)]
    Library(#[from] ddl_goal::LibraryError),
    #[error(transparent)]
    Network(#[from] ddl_network::NetworkError),
    #[cfg(feature = "torch")]
    #[error(transparent)]
    Torch(#[from] ddl_star::StarError),
    #[error(
        "{what} needs libtorch, and this program is built without it; in a checkout of the project, run \
         `cargo xtask setup` and `cargo build --release -p ddl-cli --features torch` (docs/libtorch.md)"
    )]
    WithoutLibtorch { what: &'static str },
    #[error(transparent)]
    Forecast(#[from] ddl_core::ForecastError),
    #[cfg(any(feature = "report", feature = "torch"))]
    #[error(transparent)]
    Evaluation(#[from] ddl_eval::EvaluationError),
    #[cfg(feature = "report")]
    #[error(transparent)]
    Report(#[from] ddl_report::ReportError),
    #[error("validation = {0} is out of range: it is a share of the recordings' time, at least 0 and below 1")]
    Validation(f64),
    #[error(
        "no pedestrian in the validation part was observed at 20 consecutive time steps; keep {}",
        more_for_validation(*.recordings)
    )]
    NothingToValidateOn { recordings: usize },
    #[error(
        "a patience of {patience} epochs with validation = {validation} is not allowed: use a patience of at least 1, \
         and keep a share above 0 or whole recordings for validation"
    )]
    Patience { patience: usize, validation: f64 },
    #[error("{field} = {share} is out of range: 0 to 1")]
    GoalShare { field: &'static str, share: f64 },
    #[error("the query of the goals reads the first future position: goals of a forecast need the query `observed`")]
    GoalQuery,
    #[error(
        "the training recordings hold {tracks} tracks of 20 steps, but the published goal estimator, which evaluation \
         also runs, retrieves {experts}; train on more or longer recordings (the validation part does not count)"
    )]
    TooFewTracks { tracks: usize, experts: usize },
    #[error("run {}: {problem}", path.display())]
    Run { path: PathBuf, problem: String },
    #[error("model {model}: {problem}")]
    Model { model: String, problem: String },
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    /// The caller asked to stop. Training keeps its saved steps; an evaluation starts again from the beginning.
    #[error("interrupted; a training keeps its saved steps, and the same command continues from them")]
    Interrupted,
}

fn memory_of_scenes(path: &Path, is_folder: bool) -> String {
    let path = path.display();
    if is_folder {
        format!("{path} is a folder, and the frames name no scenes; name a file, or name the scenes")
    } else {
        format!(
            "{path} is a file of one place, and the frames name scenes; name a folder that is there, for a file of \
             each scene"
        )
    }
}

/// Advice for a validation part without windows, given the number of recordings.
pub(crate) fn more_for_validation(recordings: usize) -> String {
    let whole = match recordings {
        0 | 1 => String::new(),
        _ => format!(", or whole recordings ({})", Setting::ValidationRecordings.to("NAME")),
    };
    format!("a larger share, such as {}{whole}", Setting::Validation.to(0.4))
}

impl DdlError {
    pub(crate) fn run(path: impl Into<PathBuf>, problem: impl Into<String>) -> Self {
        Self::Run { path: path.into(), problem: problem.into() }
    }

    pub(crate) fn io(path: impl Into<PathBuf>, source: std::io::Error) -> Self {
        Self::Io { path: path.into(), source }
    }
}
