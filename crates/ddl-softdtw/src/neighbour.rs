//! What a search finds.

/// A candidate found by a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Position of the candidate in the list the index was built from, from 0.
    pub index: usize,
    /// Normalised soft-DTW distance to the query, in the unit of the cost, evaluated in `f64`; exactly 0 for a candidate
    /// that equals the query.
    pub distance: f64,
}
