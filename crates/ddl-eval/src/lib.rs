#![doc = include_str!("../README.md")]

pub mod baseline;
mod conditions;
pub mod document;
mod error;
pub mod figure;
mod forecast;
mod forecaster;
pub mod gallery;
pub mod leak;
pub mod literature;
pub mod metric;
mod moment;
mod motion_kind;
pub mod page;
mod protocol;
mod report;
mod scene;
mod scores;
mod training_curve;

pub use conditions::{Conditions, ResultRow};
pub use error::{EvaluationError, ForecastError, ForecastShapeError, MeasureError, ReportError};
pub use figure::error::{FigureError, GoalCaseProblem};
pub use forecast::Forecast;
pub use forecaster::Forecaster;
pub use metric::stability::StabilityScores;
pub use moment::{Moment, MomentHypothesis, MomentWalker};
pub use motion_kind::MotionKind;
pub use protocol::{Protocol, UnknownProtocol};
pub use report::Report;
pub use scene::Scene;
pub use scores::Scores;
pub use training_curve::{EpochPoint, TrainingCurve};
