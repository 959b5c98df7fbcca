#![doc = include_str!("../README.md")]

pub mod baseline;
pub mod category;
mod conditions;
mod error;
pub mod external;
#[cfg(test)]
mod fixture;
mod forecast;
mod forecaster;
pub mod leak;
pub mod metric;
mod pedestrian_scores;
mod protocol;
pub mod region;
pub mod representative;
mod scene;
mod scores;
pub mod significance;

pub use category::{Category, CategoryScores, MotionKind};
pub use conditions::{Conditions, RecordingErrors, ResultRow};
pub use error::{EvaluationError, ForecastError, ForecastShapeError, MeasureError, WindowProblem};
pub use forecast::Forecast;
pub use forecaster::Forecaster;
pub use metric::stability::StabilityScores;
pub use protocol::Protocol;
pub use region::{AdaptiveRegions, Disc, RegionTable, TrackedQuantiles};
pub use scene::Scene;
pub use scores::Scores;
