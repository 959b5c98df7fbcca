//! Errors of pages.

use crate::ReportError;

/// A page cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum PageError {
    #[error(transparent)]
    Report(#[from] ReportError),
    #[error("cannot write the data of the page as JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error("moment {index} (recording `{recording}`, frame {frame}): {problem}")]
    Moment {
        index: usize,
        recording: String,
        frame: i64,
        problem: String,
    },
    #[error(
        "training curve {index} (fold `{fold}`, variant `{variant}`, seed {seed}): epoch {epoch} follows {before}; \
         epochs must ascend"
    )]
    Epochs {
        index: usize,
        fold: String,
        variant: String,
        seed: u64,
        epoch: usize,
        before: usize,
    },
}

#[derive(Debug, thiserror::Error)]
pub(super) enum SnapshotProblem {
    #[error("pedestrian {pedestrian} has {found} positions in `{field}`, not {expected}")]
    Length {
        pedestrian: usize,
        field: &'static str,
        expected: usize,
        found: usize,
    },
    #[error(
        "pedestrian {pedestrian} has the coordinate {value} m in `{field}`; coordinates must be within 1000 km of the \
         origin"
    )]
    Coordinate {
        pedestrian: usize,
        field: &'static str,
        value: f64,
    },
    #[error("hypothesis {hypothesis} of pedestrian {pedestrian} has the weight {weight}, which is not between 0 and 1")]
    Weight {
        pedestrian: usize,
        hypothesis: usize,
        weight: f64,
    },
    #[error("{0}")]
    Empty(&'static str),
    #[error("the pick `{show}` names pedestrian {pedestrian} of {pedestrians}, counted from 0")]
    Highlight {
        show: crate::gallery::HighlightKind,
        pedestrian: usize,
        pedestrians: usize,
    },
}
