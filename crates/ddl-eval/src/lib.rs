#![doc = include_str!("../README.md")]
//!
//! ## Forecasts of other programs
//!
//! [`external::read`] reads the file of another program and [`external::measure`] scores it; `docs/your-model.md`
//! describes the files. A model that certifies its hypotheses passes the results with
//! [`Forecast::with_certified`](ddl_core::Forecast::with_certified); the share of certified hypotheses is then scored
//! too.
//!
//! ## Cost
//!
//! Scoring 24,254 pedestrians (the size of univ) with 20 hypotheses each, by every metric and category, takes a second
//! on two cores (bench `scores`, commit 37cd494). The result does not depend on the number of threads.
//! Densities were compared with scipy: `tests/reference/distribution.py` writes the numbers that a test reads.

pub mod baseline;
mod category_scores;
mod conditions;
mod error;
pub mod external;
#[cfg(test)]
mod fixture;
pub mod leak;
pub mod metric;
mod motion_kind;
mod pedestrian_scores;
mod protocol;
mod scored_window;
mod scores;
pub mod significance;

pub use category_scores::CategoryScores;
pub use conditions::{Conditions, RecordingErrors, ResultRow};
pub use error::{EvaluationError, WindowProblem};
pub use metric::deployable::DeployableErrors;
pub use metric::joint::{FutureCollisions, JointScores};
pub use metric::stability::StabilityScores;
pub use motion_kind::MotionKind;
pub use protocol::Protocol;
pub use scored_window::ScoredWindow;
pub use scores::Scores;
