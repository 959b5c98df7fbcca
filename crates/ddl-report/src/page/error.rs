//! Errors of pages.

use crate::error::ReportError;

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
