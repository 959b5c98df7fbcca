use std::path::PathBuf;

/// Errors of `ddl`. Messages say what is wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum DdlError {
    #[error(transparent)]
    Data(#[from] ddl_data::DataError),
    #[error(transparent)]
    Live(#[from] ddl_data::LiveError),
    #[error(
        "the memory was made with {memory} frames in a step of 0.4 s ({} a second), these tracks have {camera} ({} a second): use a \
         memory of this rate, or a new file", rate(*.memory), rate(*.camera)
    )]
    MemoryFrameStep { camera: i64, memory: i64 },
    #[error(
        "another scene would be more than {limit}; a scene is forgotten when no frame of it has come for {minutes} minutes: \
         watch the others in another process"
    )]
    TooManyScenes { limit: usize, minutes: u64 },
    #[error(
        "{limit} frames wait to be forecast from; forecast some before the next is observed, or keep the latest of each scene alone"
    )]
    TooManyWaiting { limit: usize },
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
        "{what} needs libtorch, which this program is built without: in a checkout of the project, \
         `cargo xtask setup` brings it in and `cargo build --release -p ddl-cli --features torch` builds with it (docs/libtorch.md)"
    )]
    WithoutLibtorch { what: &'static str },
    #[error(transparent)]
    Forecast(#[from] ddl_eval::ForecastError),
    #[error(transparent)]
    Evaluation(#[from] ddl_eval::EvaluationError),
    #[error(transparent)]
    Measure(#[from] ddl_eval::MeasureError),
    #[error(transparent)]
    Report(#[from] ddl_report::ReportError),
    #[error(
        "validation = {0} is not allowed: a share of the recordings' time, at least 0, below 1"
    )]
    Validation(f64),
    #[error(
        "nobody in the part kept for validation was seen at 20 steps in a row; keep {}",
        more_for_validation(*.recordings)
    )]
    NothingToValidateOn { recordings: usize },
    #[error(
        "a patience of {patience} epochs with {validation} of the recordings' time for validation is not allowed: at least 1 epoch, \
         and a share above 0 or whole recordings to measure epochs on"
    )]
    Patience { patience: usize, validation: f64 },
    #[error("retrieved_share = {0} is not allowed: 0 to 1")]
    RetrievedShare(f64),
    #[error("a clearance of {0} metres is not allowed: above 0 and at most 10, such as 0.4")]
    Clearance(f64),
    #[error(
        "the variant `{variant}` has no flow that could mind others: its network emits \
         positions; use a model of the variant `full` or `no-goal-shift`"
    )]
    NoFlow { variant: ddl_network::Variant },
    #[error(
        "{tracks} tracks of 20 steps to train on, but the published goal estimator, which evaluation runs too, retrieves {experts}; train on more or longer \
         recordings (what is kept for validation does not count)"
    )]
    TooFewTracks { tracks: usize, experts: usize },
    #[error(transparent)]
    Figure(#[from] ddl_report::FigureError),
    #[error(transparent)]
    Page(#[from] ddl_report::page::PageError),
    #[error("run {}: {problem}", path.display())]
    Run { path: PathBuf, problem: String },
    #[error("model {model}: {problem}")]
    Model { model: String, problem: String },
    #[error("{}: {source}", path.display())]
    Io {
        path: PathBuf,
        source: std::io::Error,
    },
    /// The caller asked to stop. Training has saved its steps; an evaluation starts anew.
    #[error("interrupted; what training has saved stays, and the same command goes on from there")]
    Interrupted,
}

/// Frames in a second, where so many make a step of 0.4 s.
fn rate(frame_step: i64) -> f64 {
    frame_step as f64 / ddl_data::TIME_STEP
}

/// What to keep where the validation part of so many recordings holds no window.
pub(crate) fn more_for_validation(recordings: usize) -> String {
    let whole = match recordings {
        0 | 1 => "",
        _ => ", or whole recordings (--validation-recordings NAME)",
    };
    format!("a larger share, such as --validation 0.4{whole}")
}

impl DdlError {
    pub(crate) fn run(path: impl Into<PathBuf>, problem: impl Into<String>) -> Self {
        Self::Run {
            path: path.into(),
            problem: problem.into(),
        }
    }

    pub(crate) fn io(path: impl Into<PathBuf>, source: std::io::Error) -> Self {
        Self::Io {
            path: path.into(),
            source,
        }
    }
}
