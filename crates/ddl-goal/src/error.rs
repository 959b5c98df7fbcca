//! Errors of parameters, tracks and libraries.

use ddl_softdtw::{SearchError, SoftDtwError};
use thiserror::Error;

/// An invalid parameter of the goal estimator.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum ParamsError {
    #[error("{field} is {value}: it must be {rule}")]
    Count { field: &'static str, value: usize, rule: &'static str },
    #[error("gamma is {gamma}: it must be finite and not negative (the paper uses 1)")]
    InvalidGamma { gamma: f64 },
    #[error("query is published-future and frame is heading: the query that reads the future requires frame world")]
    FutureInHeadingFrame,
}

/// A track that cannot be used.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum TrackError {
    #[error("the track has {positions} positions, at least {needed} are needed")]
    TooShort { positions: usize, needed: usize },
    #[error("the track has {positions} positions, a track of the library needs exactly {needed}")]
    WrongLength { positions: usize, needed: usize },
    #[error("position {index} is ({x}, {y}): must be finite")]
    NonFinite { index: usize, x: f64, y: f64 },
    #[error("the step from position {index} is too long for a velocity in the range of f64")]
    VelocityOverflow { index: usize },
}

/// A library of experts cannot be created.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum LibraryError {
    #[error("the library has no tracks: give it complete tracks of pedestrians from the training scenes")]
    Empty,
    #[error("the time step is {time_step} s: it must be finite and positive")]
    InvalidTimeStep { time_step: f64 },
    #[error("track {index} of the library: {source}")]
    Track { index: usize, source: TrackError },
}

/// Goals cannot be estimated.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum GoalError {
    #[error("goals of given endpoints: {problem}")]
    Ends { problem: String },
    #[error(
        "the library holds {tracks} tracks but {experts} experts are to be retrieved: add tracks or lower `experts`"
    )]
    TooFewTracks { tracks: usize, experts: usize },
    #[error(transparent)]
    Params(#[from] ParamsError),
    #[error(transparent)]
    Library(#[from] LibraryError),
    #[error("the observed track: {0}")]
    Track(#[from] TrackError),
    #[error("track {index} of the batch: {source}")]
    BatchTrack { index: usize, source: Box<GoalError> },
    #[error(transparent)]
    SoftDtw(#[from] SoftDtwError),
    #[error("the search for similar pedestrians: {0}")]
    Search(#[from] SearchError),
    #[error(
        "the clustering of the experts' endpoints: point {index} is ({x}, {y}): coordinates must be finite and below \
         1e150"
    )]
    EndOutOfRange { index: usize, x: f64, y: f64 },
}
