//! Why a page cannot be made.

use crate::ReportError;

/// A page cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PageError {
    /// The report cannot be written as JSON.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// Data of the page cannot be written as JSON.
    #[error("the data of the page cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A moment is not whole.
    #[error("moment {index} (recording `{recording}`, frame {frame}): {problem}")]
    Moment {
        /// Which moment, from 0.
        index: usize,
        /// Its recording.
        recording: String,
        /// Its last observed frame.
        frame: i64,
        /// What is wrong.
        problem: MomentProblem,
    },
    /// A training curve is not in order.
    #[error(
        "training curve {index} (fold `{fold}`, variant `{variant}`, seed {seed}): epoch {epoch} follows {before}; \
         epochs must ascend"
    )]
    Epochs {
        /// Which curve, from 0.
        index: usize,
        /// Its fold.
        fold: String,
        /// Its variant.
        variant: String,
        /// Its seed.
        seed: u64,
        /// The epoch found.
        epoch: usize,
        /// The one before it.
        before: usize,
    },
}

/// What is wrong with a [`Moment`](crate::Moment).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MomentProblem {
    /// A path has the wrong number of positions.
    #[error("walker {pedestrian} has {found} positions in `{field}`, not {expected}")]
    Length {
        /// Which pedestrian, from 0.
        pedestrian: usize,
        /// Which path.
        field: &'static str,
        /// Positions needed.
        expected: usize,
        /// Positions given.
        found: usize,
    },
    /// A position that is no number, or too far away to be drawn.
    #[error(
        "walker {pedestrian} has the coordinate {value} m in `{field}`; coordinates must be within 1000 km of the origin"
    )]
    Coordinate {
        /// Which pedestrian, from 0.
        pedestrian: usize,
        /// Which path.
        field: &'static str,
        /// The coordinate, metres.
        value: f64,
    },
    /// A weight is not a probability.
    #[error(
        "hypothesis {hypothesis} of walker {pedestrian} has the weight {weight}, which is not between 0 and 1"
    )]
    Weight {
        /// Which pedestrian, from 0.
        pedestrian: usize,
        /// Which hypothesis, from 0.
        hypothesis: usize,
        /// Its weight.
        weight: f64,
    },
    /// Nobody, or nothing forecast.
    #[error("{0}")]
    Empty(&'static str),
    /// A pick names somebody who is not there.
    #[error(
        "the pick `{show}` names walker {pedestrian}, and there are {pedestrians}, counted from 0"
    )]
    Pick {
        /// What the pick shows.
        show: crate::gallery::Show,
        /// The pedestrian named.
        pedestrian: usize,
        /// Pedestrians there are.
        pedestrians: usize,
    },
}
