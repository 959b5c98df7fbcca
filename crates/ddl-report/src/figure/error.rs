//! Errors of figures.

/// A figure cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum FigureError {
    #[error("the window holds {expected} pedestrians, the forecast {found}")]
    Pedestrians { expected: usize, found: usize },
    #[error("a picture of goals holds 1 to {most} cases, found {found}; draw several pictures")]
    Cases { found: usize, most: usize },
    #[error("a picture of shares holds 1 to {most} recordings, found {found}; draw several pictures")]
    Recordings { found: usize, most: usize },
    #[error("case `{case}`: {problem}")]
    GoalCase { case: String, problem: String },
}
