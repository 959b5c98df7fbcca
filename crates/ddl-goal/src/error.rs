//! What can be wrong with parameters, tracks and libraries, said so that the reader knows where to look.

use ddl_softdtw::{SearchError, SoftDtwError};
use thiserror::Error;

/// A parameter of the goal estimator that makes no sense.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum ParamsError {
    /// No experts are asked for.
    #[error("experts is 0: at least one similar walker must be retrieved (the paper uses 100)")]
    NoExperts,
    /// No goals are asked for.
    #[error("clusters is 0: at least one goal must be estimated (the paper uses 20)")]
    NoClusters,
    /// k-means is never run.
    #[error(
        "restarts is 0: k-means must be run at least once (the published code runs it 10 times)"
    )]
    NoRestarts,
    /// The smoothing of soft-DTW is out of range.
    #[error("gamma is {gamma}: it must be finite and not negative (the paper uses 1)")]
    InvalidGamma { gamma: f64 },
    /// The published query, which reads the future, in a frame it was not published with.
    #[error(
        "query is published-future and frame is heading: the query that reads the future belongs to frame world"
    )]
    FutureInHeadingFrame,
}

/// A track that cannot be used.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum TrackError {
    /// The track has too few positions.
    #[error("the track has {found} positions, {needed} are needed")]
    TooShort { found: usize, needed: usize },
    /// A track of the library has the wrong number of positions.
    #[error("the track has {found} positions, one of the library has exactly {needed}")]
    WrongLength { found: usize, needed: usize },
    /// A position that is read is NaN or infinite.
    #[error("position {index} is ({x}, {y}): must be finite")]
    NonFinite { index: usize, x: f64, y: f64 },
    /// Two positions are so far apart that their difference is not finite.
    #[error("the step from position {index} is too long for a velocity in the range of f64")]
    VelocityOverflow { index: usize },
}

/// Why a library of experts could not be made.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum LibraryError {
    /// No tracks were given.
    #[error(
        "the library has no tracks: give it complete tracks of walkers from the training scenes"
    )]
    Empty,
    /// The time between two positions is not a positive number of seconds.
    #[error("the time step is {time_step} s: it must be finite and positive")]
    InvalidTimeStep { time_step: f64 },
    /// One of the tracks cannot be used.
    #[error("track {index} of the library: {source}")]
    Track { index: usize, source: TrackError },
}

/// Why goals could not be estimated.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum GoalError {
    /// Ends that goals cannot be chosen for.
    #[error("goals of given ends: {problem}")]
    Ends { problem: String },
    /// The library holds fewer tracks than experts are to be retrieved.
    #[error(
        "the library holds {tracks} tracks but {experts} experts are to be retrieved: give it more tracks or lower `experts`"
    )]
    TooFewTracks { tracks: usize, experts: usize },
    /// The library cannot be used.
    #[error(transparent)]
    Library(#[from] LibraryError),
    /// The observed track cannot be used.
    #[error("the observed track: {0}")]
    Track(#[from] TrackError),
    /// One of a batch of observed tracks cannot be used.
    #[error("track {index} of the batch: {source}")]
    BatchTrack {
        index: usize,
        source: Box<GoalError>,
    },
    /// Soft-DTW refused its parameters.
    #[error(transparent)]
    SoftDtw(#[from] SoftDtwError),
    /// The search for similar walkers failed.
    #[error("the search for similar walkers: {0}")]
    Search(#[from] SearchError),
    /// The end of an expert is NaN, infinite, or too large to square.
    #[error(
        "the clustering of the experts' endpoints: point {index} is ({x}, {y}): coordinates must be finite and below 1e150"
    )]
    EndOutOfRange { index: usize, x: f64, y: f64 },
}
