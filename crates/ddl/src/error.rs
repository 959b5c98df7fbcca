//! What can go wrong in the facade.

use std::path::PathBuf;

/// Errors of `ddl`. Messages say what is wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DdlError {
    /// Recordings could not be read.
    #[error(transparent)]
    Data(#[from] ddl_data::DataError),
    /// A frame cannot be added to live tracks.
    #[error(transparent)]
    Live(#[from] ddl_data::LiveError),
    /// Goals could not be estimated.
    #[error(transparent)]
    Goal(#[from] ddl_goal::GoalError),
    /// The parameters of the goal estimator are out of range.
    #[error(transparent)]
    GoalParameters(#[from] ddl_goal::ParamsError),
    /// The expert library could not be built.
    #[error(transparent)]
    Library(#[from] ddl_goal::LibraryError),
    /// The network failed, or what it is to be made of cannot be used.
    #[error(transparent)]
    Network(#[from] ddl_network::NetworkError),
    /// Training, or libtorch, failed.
    #[cfg(feature = "torch")]
    #[error(transparent)]
    Torch(#[from] ddl_star::StarError),
    /// Something was asked that needs libtorch.
    #[error(
        "{what} needs libtorch, which this program is built without: in a checkout of the project, \
         `cargo xtask setup` brings it in and `cargo build --release -p ddl-cli --features torch` builds with it (docs/libtorch.md)"
    )]
    WithoutLibtorch {
        /// What was asked for.
        what: &'static str,
    },
    /// A forecast could not be made or does not fit its window.
    #[error(transparent)]
    Forecast(#[from] ddl_eval::ForecastError),
    /// Forecasts could not be scored.
    #[error(transparent)]
    Evaluation(#[from] ddl_eval::EvaluationError),
    /// A baseline could not be measured.
    #[error(transparent)]
    Measure(#[from] ddl_eval::MeasureError),
    /// A report could not be put together or written.
    #[error(transparent)]
    Report(#[from] ddl_report::ReportError),
    /// The share of the training recordings kept for validation is no share.
    #[error(
        "validation = {0} is not allowed: a share of the recordings' time, at least 0, below 1"
    )]
    Validation(f64),
    /// Early stopping has nothing to measure epochs on.
    #[error(
        "nobody in the part kept for validation was seen at 20 steps in a row; keep {}",
        more_for_validation(*.recordings)
    )]
    NothingToValidateOn {
        /// Recordings that are learned from or validated on.
        recordings: usize,
    },
    /// Early stopping without validation, or without patience.
    #[error(
        "a patience of {patience} epochs with {validation} of the recordings' time for validation is not allowed: at least 1 epoch, \
         and a share above 0 or whole recordings to measure epochs on"
    )]
    Patience {
        /// Epochs to wait.
        patience: usize,
        /// Share of the time kept.
        validation: f64,
    },
    /// The share of the retrieved goals beside the proposed ones is no share.
    #[error("retrieved_share = {0} is not allowed: 0 to 1")]
    RetrievedShare(f64),
    /// The distance to keep from others is no distance.
    #[error("a clearance of {0} metres is not allowed: above 0 and at most 10, such as 0.4")]
    Clearance(f64),
    /// Something was asked of the flow of a model that has none.
    #[error(
        "the variant `{variant}` has no flow that could mind others: its network emits \
         positions; use a model of the variant `full` or `no-goal-shift`"
    )]
    NoFlow {
        /// The variant of the model.
        variant: ddl_network::Variant,
    },
    /// The training set holds fewer tracks than the published goal estimator retrieves.
    #[error(
        "{tracks} tracks of 20 steps to train on, but the published goal estimator, which evaluation runs too, retrieves {experts}; train on more or longer \
         recordings (what is kept for validation does not count)"
    )]
    TooFewTracks {
        /// Tracks there are.
        tracks: usize,
        /// Experts retrieved.
        experts: usize,
    },
    /// A picture could not be drawn.
    #[error(transparent)]
    Figure(#[from] ddl_report::FigureError),
    /// The page of a report could not be made.
    #[error(transparent)]
    Page(#[from] ddl_report::page::PageError),
    /// A run directory that cannot be used.
    #[error("run {}: {problem}", path.display())]
    Run {
        /// The directory or the file in it.
        path: PathBuf,
        /// What is wrong with it, and what to do.
        problem: String,
    },
    /// A packed model that cannot be used.
    #[error("model {model}: {problem}")]
    Model {
        /// Its file or name.
        model: String,
        /// What is wrong with it, and what to do.
        problem: String,
    },
    /// Reading or writing a file failed.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The caller asked to stop. Training has saved its steps; an evaluation starts anew.
    #[error("interrupted; what training has saved stays, and the same command goes on from there")]
    Interrupted,
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
