//! The goal estimator: retrieve similar walkers, cluster where they ended.

use rayon::prelude::*;

use crate::error::GoalError;
use crate::goal_set::GoalSet;
use crate::kmeans::KMeans;
use crate::library::ExpertLibrary;
use crate::params::ValidGoalEstimatorParams;
use crate::retrieve::Retriever;

/// Estimates where walkers are heading from how similar walkers of a library went on.
///
/// 1. The observed velocities (m/s, forward differences) are compared with those of every track of the library in the
///    normalised soft-DTW distance, and the N nearest are the experts (equations 4 and 5 of the paper).
/// 2. The end of each expert is taken relative to its first position (equation 6).
/// 3. k-means of these ends gives K goals, placed at the first observed position.
///
/// The result depends on the library, the parameters and the positions that [`crate::QuerySpan`] reads: not on the other
/// tracks of a batch, nor their order, nor the number of threads.
///
/// # References
/// Wang, Zhi, Batista, Chandra, *Pedestrian trajectory prediction using dynamics-based deep learning*, ICRA 2024,
/// section II-D.
#[derive(Clone, Debug)]
pub struct GoalEstimator {
    params: ValidGoalEstimatorParams,
    library: ExpertLibrary,
    retriever: Retriever,
    kmeans: KMeans,
}

impl GoalEstimator {
    /// Prepares an estimator.
    ///
    /// # Errors
    /// [`GoalError::TooFewTracks`] when the library is smaller than the number of experts; errors of a library whose
    /// velocities leave the range of `f64`.
    pub fn new(
        params: ValidGoalEstimatorParams,
        library: ExpertLibrary,
    ) -> Result<Self, GoalError> {
        if library.len() < params.experts() {
            let (tracks, experts) = (library.len(), params.experts());
            return Err(GoalError::TooFewTracks { tracks, experts });
        }
        let retriever = Retriever::new(&library, params.gamma(), params.query())?;
        let kmeans = KMeans::new(params.clusters()).restarts(params.restarts());
        Ok(Self {
            params,
            library,
            retriever,
            kmeans,
        })
    }

    /// The parameters.
    pub fn params(&self) -> &ValidGoalEstimatorParams {
        &self.params
    }

    /// The library the goals come from.
    pub fn library(&self) -> &ExpertLibrary {
        &self.library
    }

    /// The goals of one walker.
    ///
    /// # Shapes
    /// `track`: the observed positions (m), at least 8, at least 9 for [`crate::QuerySpan::PublishedFuture`]; later ones
    /// are not read.
    ///
    /// # Errors
    /// A track that is too short, not finite, or so far out that distances leave the range of `f64`.
    pub fn estimate(&self, track: &[[f64; 2]]) -> Result<GoalSet, GoalError> {
        let velocities = self.retriever.velocities(track)?;
        let experts = self
            .retriever
            .nearest_to_velocities(&velocities, self.params.experts())?;
        let ends: Vec<[f64; 2]> = experts
            .iter()
            .map(|expert| self.library.end(expert.index))
            .collect();
        let clustering = self
            .kmeans
            .fit(&ends, self.params.seed(), stream_of(&velocities))?;
        Ok(GoalSet::new(track[0], &clustering, experts))
    }

    /// The goals of many walkers, in parallel over the current `rayon` pool.
    ///
    /// # Errors
    /// [`GoalError::BatchTrack`] for the first track that [`GoalEstimator::estimate`] refuses.
    pub fn estimate_batch(&self, tracks: &[&[[f64; 2]]]) -> Result<Vec<GoalSet>, GoalError> {
        let estimated: Vec<_> = tracks
            .par_iter()
            .map(|track| self.estimate(track))
            .collect();
        estimated
            .into_iter()
            .enumerate()
            .map(|(index, result)| {
                result.map_err(|source| GoalError::BatchTrack {
                    index,
                    source: Box::new(source),
                })
            })
            .collect()
    }
}

/// The stream of random numbers of a query: the FNV-1a hash of what is compared, so that it follows from the query alone.
fn stream_of(velocities: &[[f64; 2]]) -> u64 {
    let bytes = velocities
        .as_flattened()
        .iter()
        .flat_map(|value| value.to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
