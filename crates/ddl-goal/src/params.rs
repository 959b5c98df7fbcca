//! The parameters of the goal estimator, before and after they are checked.

use serde::{Deserialize, Serialize};

use crate::error::ParamsError;
use crate::frame::RetrievalFrame;
use crate::span::QuerySpan;

/// Parameters of a [`crate::GoalEstimator`], to be set one by one and then checked.
///
/// | parameter | default | published | |
/// |---|---|---|---|
/// | `frame` | [`RetrievalFrame::Heading`] | [`RetrievalFrame::World`] | in which coordinates walkers are compared |
/// | `experts` | 800 | 100 | similar walkers retrieved, N of the paper |
/// | `clusters` | 20 | 20 | goals, K of the paper |
/// | `query` | [`QuerySpan::Observed`] | [`QuerySpan::PublishedFuture`] | what the retrieval may look at |
/// | `gamma` | 1 | 1 | smoothing of soft-DTW (m²/s²), in the frame `World` only |
/// | `restarts` | 10 | 10 | runs of k-means, of which the best counts, in the frame `World` only |
/// | `seed` | 0 | 0 | of the seeding of k-means, in the frame `World` only |
///
/// In the frame `Heading` each track counts twice, as itself and as its mirror image, and a library with fewer than
/// `experts` of those is retrieved whole; in `World` it is refused.
///
/// # Examples
/// ```
/// use ddl_goal::GoalEstimatorParams;
/// let params = GoalEstimatorParams::default().experts(50).seed(7).check()?;
/// assert_eq!((params.experts(), params.clusters()), (50, 20));
/// # Ok::<(), ddl_goal::ParamsError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GoalEstimatorParams {
    frame: RetrievalFrame,
    experts: usize,
    clusters: usize,
    gamma: f64,
    restarts: usize,
    seed: u64,
    query: QuerySpan,
}

impl Default for GoalEstimatorParams {
    /// The estimator that did best on validation recordings (docs/goals.md).
    fn default() -> Self {
        Self {
            frame: RetrievalFrame::Heading,
            experts: 800,
            clusters: 20,
            gamma: 1.0,
            restarts: 10,
            seed: 0,
            query: QuerySpan::Observed,
        }
    }
}

impl GoalEstimatorParams {
    /// The estimator exactly as published: the query reads the first future position.
    #[must_use]
    pub fn published() -> Self {
        Self::default().into_published()
    }

    /// The estimator exactly as published, with the seed of this one.
    #[must_use]
    pub fn into_published(self) -> Self {
        Self {
            frame: RetrievalFrame::World,
            experts: 100,
            clusters: 20,
            gamma: 1.0,
            restarts: 10,
            seed: self.seed,
            query: QuerySpan::PublishedFuture,
        }
    }

    /// In which coordinates walkers are compared.
    #[must_use]
    pub fn frame(mut self, frame: RetrievalFrame) -> Self {
        self.frame = frame;
        self
    }

    /// Number of similar walkers to retrieve.
    #[must_use]
    pub fn experts(mut self, experts: usize) -> Self {
        self.experts = experts;
        self
    }

    /// Number of goals.
    #[must_use]
    pub fn clusters(mut self, clusters: usize) -> Self {
        self.clusters = clusters;
        self
    }

    /// Smoothing of soft-DTW (m²/s²); 0 is hard DTW.
    #[must_use]
    pub fn gamma(mut self, gamma: f64) -> Self {
        self.gamma = gamma;
        self
    }

    /// Number of runs of k-means.
    #[must_use]
    pub fn restarts(mut self, restarts: usize) -> Self {
        self.restarts = restarts;
        self
    }

    /// Seed of k-means.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// What the retrieval may look at.
    #[must_use]
    pub fn query(mut self, query: QuerySpan) -> Self {
        self.query = query;
        self
    }

    /// Checks the parameters.
    ///
    /// # Errors
    /// A count of 0, a gamma that is negative or not finite, or the query that reads the future in the frame `Heading`.
    pub fn check(self) -> Result<ValidGoalEstimatorParams, ParamsError> {
        if self.experts == 0 {
            return Err(ParamsError::NoExperts);
        }
        if self.clusters == 0 {
            return Err(ParamsError::NoClusters);
        }
        if self.restarts == 0 {
            return Err(ParamsError::NoRestarts);
        }
        if !(self.gamma.is_finite() && self.gamma >= 0.0) {
            return Err(ParamsError::InvalidGamma { gamma: self.gamma });
        }
        if self.frame == RetrievalFrame::Heading && self.query.reads_future() {
            return Err(ParamsError::FutureInHeadingFrame);
        }
        Ok(ValidGoalEstimatorParams(self))
    }
}

/// Parameters that passed [`GoalEstimatorParams::check`].
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct ValidGoalEstimatorParams(GoalEstimatorParams);

impl ValidGoalEstimatorParams {
    /// In which coordinates walkers are compared.
    pub fn frame(&self) -> RetrievalFrame {
        self.0.frame
    }

    /// Number of similar walkers to retrieve.
    pub fn experts(&self) -> usize {
        self.0.experts
    }

    /// Number of goals.
    pub fn clusters(&self) -> usize {
        self.0.clusters
    }

    /// Smoothing of soft-DTW (m²/s²).
    pub fn gamma(&self) -> f64 {
        self.0.gamma
    }

    /// Number of runs of k-means.
    pub fn restarts(&self) -> usize {
        self.0.restarts
    }

    /// Seed of k-means.
    pub fn seed(&self) -> u64 {
        self.0.seed
    }

    /// What the retrieval may look at.
    pub fn query(&self) -> QuerySpan {
        self.0.query
    }
}

#[cfg(test)]
mod tests {
    use super::GoalEstimatorParams;
    use crate::error::ParamsError;
    use crate::frame::RetrievalFrame;
    use crate::span::QuerySpan;

    #[test]
    fn each_senseless_value_is_refused() {
        let params = GoalEstimatorParams::default;
        assert_eq!(params().experts(0).check(), Err(ParamsError::NoExperts));
        assert_eq!(params().clusters(0).check(), Err(ParamsError::NoClusters));
        assert_eq!(params().restarts(0).check(), Err(ParamsError::NoRestarts));
        for gamma in [-1.0, f64::INFINITY, f64::NAN] {
            assert!(matches!(
                params().gamma(gamma).check(),
                Err(ParamsError::InvalidGamma { .. })
            ));
        }
        assert!(params().gamma(0.0).check().is_ok());
        let future = params().query(QuerySpan::PublishedFuture);
        assert_eq!(
            future.clone().check(),
            Err(ParamsError::FutureInHeadingFrame)
        );
        assert!(future.frame(RetrievalFrame::World).check().is_ok());
    }

    #[test]
    fn what_is_set_is_what_is_told() {
        let params = GoalEstimatorParams::published().experts(3).clusters(4);
        let valid = params.gamma(0.5).restarts(6).seed(7).check().unwrap();
        let counts = (valid.experts(), valid.clusters(), valid.restarts());
        assert_eq!((counts, valid.seed()), ((3, 4, 6), 7));
        assert_eq!(valid.gamma().to_bits(), 0.5_f64.to_bits());
        assert_eq!(valid.frame(), RetrievalFrame::World);
        assert_eq!(valid.query(), QuerySpan::PublishedFuture);
    }

    #[test]
    fn only_the_published_ones_read_the_future() {
        assert!(
            !GoalEstimatorParams::default()
                .check()
                .unwrap()
                .query()
                .reads_future()
        );
        assert!(
            GoalEstimatorParams::published()
                .check()
                .unwrap()
                .query()
                .reads_future()
        );
    }

    #[test]
    fn json_names_what_it_sets_and_nothing_else() {
        let json = r#"{"frame": "world", "experts": 10, "query": "published-future"}"#;
        let params: GoalEstimatorParams = serde_json::from_str(json).unwrap();
        let expected = GoalEstimatorParams::default()
            .frame(RetrievalFrame::World)
            .experts(10)
            .query(QuerySpan::PublishedFuture);
        assert_eq!(params, expected);
        assert!(serde_json::from_str::<GoalEstimatorParams>(r#"{"expert": 10}"#).is_err());
    }
}
