#![doc = include_str!("../README.md")]

pub mod baseline;
mod conditions;
mod error;
pub mod figure;
mod forecast;
mod forecaster;
pub mod foreign;
pub mod leak;
pub mod literature;
pub mod metric;
mod motion_kind;
mod protocol;
mod report;
mod scene;
mod scores;
pub mod table;

pub use conditions::{Conditions, ResultRow};
pub use error::{EvaluationError, ForecastError, ForecastShapeError, MeasureError, ReportError};
pub use figure::error::{FigureError, GoalCaseProblem};
pub use forecast::Forecast;
pub use forecaster::Forecaster;
pub use metric::stability::StabilityScores;
pub use motion_kind::MotionKind;
pub use protocol::{Protocol, UnknownProtocol};
pub use report::Report;
pub use scene::Scene;
pub use scores::Scores;
