//! Why a picture cannot be drawn.

/// A figure cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// The forecast is of other people than the window holds.
    #[error("the window holds {expected} pedestrians, the forecast {found}")]
    Pedestrians {
        /// Pedestrians in the window.
        expected: usize,
        /// Pedestrians in the forecast.
        found: usize,
    },
    /// No panel, or too many.
    #[error("a picture of goals holds 1 to {most} cases, found {found}; draw several pictures")]
    Cases {
        /// Cases given.
        found: usize,
        /// Cases allowed.
        most: usize,
    },
    /// A pedestrian with its goals cannot be shown.
    #[error("case `{case}`: {problem}")]
    GoalCase {
        /// Title of the case.
        case: String,
        /// What is wrong.
        problem: GoalCaseProblem,
    },
}

/// What is wrong with a [`GoalCase`](crate::figure::GoalCase).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GoalCaseProblem {
    /// The track is not a whole window.
    #[error("the track must hold 20 positions (8 observed, 12 true), found {found}")]
    TrackLength {
        /// Positions given.
        found: usize,
    },
    /// An expert's track is not a whole window.
    #[error("expert {index} must hold 20 positions, found {found}")]
    ExpertLength {
        /// Which expert, from 0.
        index: usize,
        /// Positions given.
        found: usize,
    },
    /// A place that is not finite, or out of all reach.
    #[error(
        "{what} is {position:?}, which is no place within 1000 km of the last observed position; are \
         these metres, in the coordinates of the track?"
    )]
    Place {
        /// Whose place.
        what: String,
        /// The place, metres.
        position: [f64; 2],
    },
    /// A weight is not a probability.
    #[error("goal {goal} has the weight {weight}, which is not between 0 and 1")]
    Weight {
        /// Which goal, from 0.
        goal: usize,
        /// Its weight.
        weight: f64,
    },
    /// The weights do not sum to 1.
    #[error("the weights sum to {sum}, not to 1; divide them by their sum")]
    NotNormalised {
        /// Sum of the weights given.
        sum: f64,
    },
}
