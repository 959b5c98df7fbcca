#![doc = include_str!("../README.md")]
//!
//! ## Which differences are compared
//!
//! [`QuerySpan::Observed`], the default, compares the 7 forward differences of the 8 observed positions. The published
//! code compares 8, the last of which reads the first position to be forecast; [`QuerySpan::PublishedFuture`]
//! reproduces that, only for comparison with published numbers. With `Observed`, no position after the 8th changes a
//! bit of the result.
//!
//! ## Reproducibility and cost
//!
//! The frame `Heading` uses no random numbers. In the frame `World`, k-means draws from `ChaCha8` with the seed of the
//! parameters, the same numbers for every pedestrian. A pedestrian has the same goals alone or in a batch, in any
//! order, on any number of threads. A rounding error in the positions moves the goals by about the same distance,
//! except at ties. One pedestrian takes about 3 million instructions with a library of 36,000 tracks: a third of a
//! millisecond on a busy core.

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
pub use library::ExpertLibrary;
pub use params::{GoalEstimatorParams, RetrievalFrame};
pub use span::QuerySpan;
