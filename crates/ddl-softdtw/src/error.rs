//! Errors of soft-DTW values, gradients and searches.

use thiserror::Error;

/// A soft-DTW value or gradient cannot be computed. A sequence is `'x'`, the first one (the query of a search), or
/// `'y'`.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum SoftDtwError {
    #[error("gamma is {gamma}: it must be finite and not negative (0 is hard DTW)")]
    InvalidGamma { gamma: f64 },
    #[error("sequence {sequence} is empty: soft-DTW needs at least one step")]
    EmptySequence { sequence: char },
    #[error("sequence {sequence}, step {step}, component {component} is {value}: must be finite")]
    NonFinite { sequence: char, step: usize, component: usize, value: f64 },
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
