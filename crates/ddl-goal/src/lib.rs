#![doc = include_str!("../README.md")]

mod error;
mod estimator;
mod frame;
mod goal_set;
mod kmeans;
mod library;
mod lloyd;
mod params;
mod points;
mod retrieve;
mod seeding;

pub use ddl_softdtw::Neighbour;
pub use error::{GoalError, KMeansError, LibraryError, ParamsError, TrackError};
pub use estimator::GoalEstimator;
pub use frame::QuerySpan;
pub use goal_set::GoalSet;
pub use kmeans::{Clustering, KMeans};
pub use library::{ExpertLibrary, TRACK_LENGTH};
pub use params::{GoalEstimatorParams, ValidGoalEstimatorParams};
pub use retrieve::Retriever;
