//! Retrieval of the walkers who moved most alike.

use ddl_softdtw::{Cost, Neighbour, SearchIndex, SoftDtw};

use crate::error::GoalError;
use crate::library::ExpertLibrary;
use crate::span::{QuerySpan, velocities};

/// Finds the tracks of a library whose velocities are nearest in the normalised soft-DTW distance.
///
/// # References
/// DDL paper, equations 4 and 5. The cost is the squared Euclidean distance, as in the published code (the text of the
/// paper says Euclidean).
#[derive(Clone, Debug)]
pub(crate) struct Retriever {
    index: SearchIndex<2>,
    time_step: f64,
    span: QuerySpan,
}

impl Retriever {
    /// Prepares a library for retrieval with smoothing `gamma` (m²/s²), comparing what `span` reads.
    ///
    /// # Errors
    /// A `gamma` that is negative or not finite, or a track whose velocities leave the range of `f64`.
    pub(crate) fn new(
        library: &ExpertLibrary,
        gamma: f64,
        span: QuerySpan,
    ) -> Result<Self, GoalError> {
        let dtw = SoftDtw::new(gamma, Cost::SquaredEuclidean)?;
        let time_step = library.time_step();
        let sequences = library.of_each(|track| velocities(track, time_step, span))?;
        Ok(Self {
            index: SearchIndex::build(&dtw, &sequences)?,
            time_step,
            span,
        })
    }

    /// The `experts` tracks of the library nearest to `track`, nearest first, ties by their place in the library.
    ///
    /// # Shapes
    /// `track`: at least 8 positions (m), 9 for [`QuerySpan::PublishedFuture`]; later ones are not read.
    ///
    /// # Errors
    /// A track that is too short or not finite.
    pub(crate) fn nearest(
        &self,
        track: &[[f64; 2]],
        experts: usize,
    ) -> Result<Vec<Neighbour>, GoalError> {
        let velocities = velocities(track, self.time_step, self.span)?;
        Ok(self.index.nearest(&velocities, experts)?)
    }
}
