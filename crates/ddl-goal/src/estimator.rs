//! The goal estimator: it retrieves similar pedestrians and places goals among their endpoints.

use crate::analogues::Analogues;
use crate::error::GoalError;
use crate::expert::Expert;
use crate::goal_set::GoalSet;
use crate::kmeans::KMeans;
use crate::library::ExpertLibrary;
use crate::params::{GoalEstimatorParams, RetrievalFrame};
use crate::span::velocities;
use ddl_softdtw::{Neighbour, SearchIndex, SoftDtw};
use rayon::prelude::*;

/// Estimates the goals of pedestrians from the endpoints of similar pedestrians in a library.
///
/// In [`RetrievalFrame::Heading`], the default, every pedestrian is described in its [`crate::HeadingFrame`] by its
/// velocities, divided by its pace. The experts are the N most similar tracks of the library, or mirror images of
/// tracks, weighted by similarity. The deviations of their endpoints from repeating the last step are clustered to K
/// goals (`docs/method.md`).
///
/// In [`RetrievalFrame::World`], the published estimator, velocities are compared by the normalised soft-DTW distance
/// (equations 4 and 5 of the paper), and k-means of the endpoints of the N nearest tracks (equation 6) gives K goals.
///
/// The result depends only on the library, the parameters and the positions that [`crate::QuerySpan`] reads.
///
/// # References
/// Wang, Zhi, Batista, Chandra, *Pedestrian trajectory prediction using dynamics-based deep learning*, ICRA 2024,
/// section II-D.
///
/// # Examples
/// ```
/// use ddl_goal::{ExpertLibrary, GoalEstimator, GoalEstimatorParams};
///
/// // Pedestrians of a training scene: 20 positions (m), 0.4 s apart, at 0.8 to 1.6 m/s.
/// let walk = |speed: f64| (0..20).map(|t| [0.4 * speed * f64::from(t), 0.0]).collect();
/// let tracks = (0..90).map(|i| walk(0.8 + 0.4 * f64::from(i % 3))).collect();
/// let params = GoalEstimatorParams { experts: 30, clusters: 3, ..Default::default() };
/// let estimator = GoalEstimator::new(params, ExpertLibrary::new(tracks, 0.4)?)?;
///
/// // A pedestrian that walks north, seen for 3.2 s.
/// let observed: Vec<[f64; 2]> = (0..8).map(|t| [5.0, 0.48 * f64::from(t)]).collect();
/// let goals = estimator.estimate(&observed)?;
/// let [x, y] = goals.goals()[0];
/// assert!((x - 5.0).abs() < 1e-6 && (y - 0.48 * 19.0).abs() < 0.1, "still on the way north");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct GoalEstimator {
    params: GoalEstimatorParams,
    library: ExpertLibrary,
    method: Preparation,
}

#[derive(Clone, Debug)]
enum Preparation {
    World(Box<SearchIndex<2>>, KMeans),
    Heading(Analogues),
}

impl GoalEstimator {
    /// Creates an estimator and its search index.
    ///
    /// # Errors
    /// [`GoalError::Params`] for invalid parameters; [`GoalError::TooFewTracks`] if the frame is
    /// [`RetrievalFrame::World`] and the library is smaller than the number of experts. Also for a library whose
    /// velocities exceed the range of `f64`.
    pub fn new(params: GoalEstimatorParams, library: ExpertLibrary) -> Result<Self, GoalError> {
        params.check()?;
        let method = match params.frame {
            RetrievalFrame::Heading => Preparation::Heading(Analogues::new(&library)?),
            RetrievalFrame::World => {
                if library.tracks().len() < params.experts {
                    let (tracks, experts) = (library.tracks().len(), params.experts);
                    return Err(GoalError::TooFewTracks { tracks, experts });
                }
                // Equations 4 and 5 of the DDL paper. The cost is the squared Euclidean distance, as in the published
                // code (the text of the paper says Euclidean).
                let sequences = library.of_each(|track| velocities(track, library.time_step, params.query))?;
                let index = SearchIndex::build(&SoftDtw::new(params.gamma)?, &sequences)?;
                Preparation::World(Box::new(index), KMeans::new(params.clusters, params.restarts))
            }
        };
        Ok(Self { params, library, method })
    }

    /// The parameters.
    pub fn params(&self) -> &GoalEstimatorParams {
        &self.params
    }

    /// The library that the goals come from.
    pub fn library(&self) -> &ExpertLibrary {
        &self.library
    }

    /// The goals of one pedestrian.
    ///
    /// # Shapes
    /// `track`: the observed positions (m), at least 8, and at least 9 for [`crate::QuerySpan::PublishedFuture`]. Later
    /// positions are not read.
    ///
    /// # Errors
    /// If the track is too short, not finite, or so far out that distances exceed the range of `f64`.
    pub fn estimate(&self, track: &[[f64; 2]]) -> Result<GoalSet, GoalError> {
        let (experts, clusters) = (self.params.experts, self.params.clusters);
        match &self.method {
            Preparation::Heading(analogues) => analogues.goals(track, experts, clusters),
            Preparation::World(index, kmeans) => {
                let velocities = velocities(track, self.library.time_step, self.params.query)?;
                let experts = index.nearest(&velocities, experts)?;
                let ends: Vec<[f64; 2]> = experts.iter().map(|expert| self.library.end(expert.index)).collect();
                let clustering = kmeans.fit(&ends, self.params.seed)?;
                let place = |[x, y]: &[f64; 2]| [track[0][0] + x, track[0][1] + y];
                let goals = clustering.centres.iter().map(place).collect();
                let share = |size: usize| size as f64 / ends.len() as f64;
                let weights = clustering.sizes().into_iter().map(share).collect();
                let expert = |neighbour: &Neighbour| Expert {
                    index: neighbour.index,
                    distance: neighbour.distance,
                    mirrored: false,
                };
                Ok(GoalSet::new(goals, weights, experts.iter().map(expert).collect()))
            }
        }
    }

    /// The goals of many pedestrians, computed in parallel on the current `rayon` pool.
    ///
    /// # Shapes
    /// One set per track, in the order of the tracks; each track (m) as for [`GoalEstimator::estimate`].
    ///
    /// # Errors
    /// [`GoalError::BatchTrack`] for the first track that [`GoalEstimator::estimate`] refuses.
    pub fn estimate_batch(&self, tracks: &[&[[f64; 2]]]) -> Result<Vec<GoalSet>, GoalError> {
        let estimated: Vec<_> = tracks.par_iter().map(|track| self.estimate(track)).collect();
        estimated
            .into_iter()
            .enumerate()
            .map(|(index, result)| result.map_err(|source| GoalError::BatchTrack { index, source: Box::new(source) }))
            .collect()
    }
}
