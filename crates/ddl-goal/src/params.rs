//! Parameters of the goal estimator.

use crate::error::ParamsError;
use crate::span::QuerySpan;
use serde::{Deserialize, Serialize};

/// Largest number of goals for a pedestrian; a forecast has 20. A file that asks for more would take all memory.
pub(crate) const MOST_CLUSTERS: usize = 1000;

/// Coordinates in which pedestrians are compared and endpoints are transferred.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RetrievalFrame {
    /// The coordinates of the recording: two pedestrians are similar only if both head the same way. The published
    /// estimator uses them, with soft-DTW and k-means.
    World,
    /// The pedestrian's own [`crate::HeadingFrame`]; every track of the library also serves as its mirror image.
    #[default]
    Heading,
}

/// Parameters of a [`crate::GoalEstimator`].
///
/// | parameter | default | published | |
/// |---|---|---|---|
/// | `frame` | [`RetrievalFrame::Heading`] | [`RetrievalFrame::World`] | coordinates of the comparison |
/// | `experts` | 800 | 100 | similar pedestrians retrieved, N of the paper |
/// | `clusters` | 20 | 20 | goals, K of the paper |
/// | `query` | [`QuerySpan::Observed`] | [`QuerySpan::PublishedFuture`] | positions that the retrieval may read |
/// | `gamma` | 1 | 1 | smoothing of soft-DTW (m²/s²), in the frame `World` only |
/// | `restarts` | 10 | 10 | runs of k-means, of which the best is used, in the frame `World` only |
/// | `seed` | 0 | 0 | seed of k-means, in the frame `World` only |
///
/// In the frame `Heading` each track counts twice, as itself and as its mirror image. If there are fewer of these than
/// `experts`, all are retrieved. In `World`, a library with fewer tracks than `experts` is refused.
///
/// # Examples
/// ```
/// use ddl_goal::GoalEstimatorParams;
/// let params = GoalEstimatorParams { experts: 50, ..Default::default() };
/// assert!(params.check().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GoalEstimatorParams {
    /// Coordinates of the comparison.
    pub frame: RetrievalFrame,
    /// Number of similar pedestrians to retrieve.
    pub experts: usize,
    /// Number of goals.
    pub clusters: usize,
    /// Smoothing of soft-DTW (m²/s²); 0 is hard DTW.
    pub gamma: f64,
    /// Number of runs of k-means.
    pub restarts: usize,
    /// Seed of k-means.
    pub seed: u64,
    /// Positions that the retrieval may read.
    pub query: QuerySpan,
}

impl Default for GoalEstimatorParams {
    /// The estimator that did best on validation recordings (docs/tried.md).
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
        Self { frame: RetrievalFrame::World, experts: 100, query: QuerySpan::PublishedFuture, ..Self::default() }
    }

    /// Checks the parameters.
    ///
    /// # Errors
    /// If a count is out of range, gamma is negative or not finite, or the query reads the future in the frame
    /// `Heading`.
    pub fn check(&self) -> Result<(), ParamsError> {
        for (field, value, most, rule) in [
            ("experts", self.experts, usize::MAX, "at least 1 (the paper uses 100)"),
            ("clusters", self.clusters, MOST_CLUSTERS, "1 to 1000 (the paper uses 20)"),
            ("restarts", self.restarts, 1000, "1 to 1000 (the published code uses 10)"),
        ] {
            if !(1..=most).contains(&value) {
                return Err(ParamsError::Count { field, value, rule });
            }
        }
        if !(self.gamma.is_finite() && self.gamma >= 0.0) {
            return Err(ParamsError::InvalidGamma { gamma: self.gamma });
        }
        if self.frame == RetrievalFrame::Heading && self.query == QuerySpan::PublishedFuture {
            return Err(ParamsError::FutureInHeadingFrame);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{GoalEstimatorParams, RetrievalFrame};

    type Fault = (fn(&mut GoalEstimatorParams), &'static str);

    #[test]
    fn each_invalid_value_is_refused() {
        let cases: [Fault; 9] = [
            (|p| p.experts = 0, "experts is 0"),
            (|p| p.clusters = 0, "clusters is 0"),
            (|p| p.clusters = 1001, "clusters is 1001: it must be 1 to 1000"),
            (|p| p.restarts = 0, "restarts is 0"),
            (|p| p.restarts = usize::MAX, "it must be 1 to 1000"),
            (|p| p.gamma = -1.0, "gamma is -1"),
            (|p| p.gamma = f64::INFINITY, "gamma is inf"),
            (|p| p.gamma = f64::NAN, "gamma is NaN"),
            (|p| p.frame = RetrievalFrame::Heading, "frame is heading"),
        ];
        for (change, expected) in cases {
            let mut params = GoalEstimatorParams::published();
            assert!(params.check().is_ok());
            change(&mut params);
            let error = params.check().unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
        let gamma = 0.0;
        let hard = GoalEstimatorParams { gamma, ..Default::default() };
        assert!(hard.check().is_ok());
    }
}
