//! Errors of reports, pages and figures.

use std::path::PathBuf;

/// A report cannot be made or read, or a page or figure of it cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum ReportError {
    #[error(
        "two results of `{row}` on fold `{fold}` name the same conditions but differ \
         (minADE {first} and {second}); remove one of them, or give them different seeds or names"
    )]
    Conflict { row: String, fold: String, first: f64, second: f64 },
    #[error("the report has format {found}; this version reads format {supported}")]
    Format { found: u32, supported: u32 },
    #[error("not a report: {0}")]
    Json(#[source] serde_json::Error),
    #[error("{path}: {source}; evaluate the run again", path = path.display())]
    Unreadable { path: PathBuf, source: Box<ReportError> },
    #[error("cannot be written as JSON: {0}")]
    Write(#[from] serde_json::Error),
    #[error("{path}: {source}", path = path.display())]
    File { path: PathBuf, source: std::io::Error },
    #[error("moment {index} (recording `{recording}`, frame {frame}): {fault}")]
    Moment { index: usize, recording: String, frame: i64, fault: MomentFault },
    #[error("the window holds {expected} pedestrians, the forecast {found}")]
    Pedestrians { expected: usize, found: usize },
}

/// Why a moment cannot be shown.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum MomentFault {
    #[error("no pedestrian")]
    NoPedestrian,
    #[error("joint futures need the same number of hypotheses of all pedestrians")]
    JointFutures,
    #[error("a group names pedestrian {member} of {count}, counted from 0")]
    Group { member: usize, count: usize },
    #[error("a pedestrian has no hypothesis")]
    NoHypothesis,
    #[error("hypothesis {hypothesis} of pedestrian {pedestrian} has the weight {weight}, which is not between 0 and 1")]
    Weight { hypothesis: usize, pedestrian: usize, weight: f64 },
    #[error("pedestrian {pedestrian} has {count} positions in `{field}`, not {expected}")]
    Length { pedestrian: usize, field: &'static str, count: usize, expected: usize },
    #[error(
        "pedestrian {pedestrian} has the coordinate {value} m in `{field}`; coordinates must be within 1000 km of the \
         origin"
    )]
    Coordinate { pedestrian: usize, field: &'static str, value: f64 },
}
