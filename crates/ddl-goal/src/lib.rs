#![doc = include_str!("../README.md")]

mod analogues;
mod central_goal;
mod choice;
mod error;
mod estimator;
mod expert;
mod geometric_median;
mod goal_set;
mod heading;
mod kmeans;
mod library;
mod lloyd;
mod motion;
mod motion_index;
mod params;
mod points;
mod seeding;
mod span;

pub use error::{GoalError, LibraryError, ParamsError, TrackError};
pub use estimator::GoalEstimator;
pub use expert::Expert;
pub use goal_set::GoalSet;
pub use heading::HeadingFrame;
pub use library::{ExpertLibrary, TRACK_LENGTH};
pub use params::{GoalEstimatorParams, RetrievalFrame, ValidGoalEstimatorParams};
pub use span::QuerySpan;
