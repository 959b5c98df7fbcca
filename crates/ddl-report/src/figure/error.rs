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

#[derive(Debug, thiserror::Error)]
pub(super) enum GoalCaseProblem {
    #[error("the track must hold 20 positions (8 observed, 12 true), found {found}")]
    TrackLength { found: usize },
    #[error("expert {index} must hold 20 positions, found {found}")]
    ExpertLength { index: usize, found: usize },
    #[error(
        "{what} is {position:?}, which is not within 1000 km of the last observed position; give metres in the \
         coordinates of the track"
    )]
    Place { what: String, position: [f64; 2] },
    #[error("goal {goal} has the weight {weight}, which is not between 0 and 1")]
    Weight { goal: usize, weight: f64 },
    #[error("the weights sum to {sum}, not to 1; divide them by their sum")]
    NotNormalised { sum: f64 },
}
