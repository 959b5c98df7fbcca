//! Errors of soft-DTW values, gradients and searches.

use std::fmt;

use thiserror::Error;

/// The sequence of a comparison that an error refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SequenceRole {
    /// The first argument, `x` (the query of a search).
    X,
    /// The second argument, `y` (the candidate of a search).
    Y,
}

impl fmt::Display for SequenceRole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "x",
            Self::Y => "y",
        })
    }
}

/// A soft-DTW value or gradient cannot be computed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum SoftDtwError {
    #[error("gamma is {gamma}: it must be finite and not negative (0 is hard DTW)")]
    InvalidGamma { gamma: f64 },
    #[error("sequence {sequence} is empty: soft-DTW needs at least one step")]
    EmptySequence { sequence: SequenceRole },
    #[error("sequence {sequence}, step {step}, component {component} is {value}: must be finite")]
    NonFinite {
        sequence: SequenceRole,
        step: usize,
        component: usize,
        value: f64,
    },
    #[error("the soft-DTW value or gradient leaves the range of f64: scale the sequences (or gamma) down")]
    Overflow,
}

/// A search cannot be prepared or answered.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum SearchError {
    #[error("no candidates were given: a search index needs at least one sequence")]
    NoCandidates,
    #[error("candidate {index}: {source}")]
    Candidate { index: usize, source: SoftDtwError },
    #[error("query: {0}")]
    Query(#[from] SoftDtwError),
    #[error("query {index} of the batch: {source}")]
    BatchQuery { index: usize, source: SoftDtwError },
}
