#![doc = include_str!("../README.md")]

pub mod baseline;
pub mod category;
mod conditions;
pub mod document;
mod error;
pub mod figure;
mod forecast;
mod forecaster;
pub mod foreign;
pub mod gallery;
pub mod leak;
pub mod literature;
pub mod metric;
mod moment;
pub mod page;
mod protocol;
mod report;
pub mod representative;
mod scene;
mod scores;
pub mod significance;
mod training_curve;
mod walker_scores;

pub use category::{Category, CategoryScores, MotionKind};
pub use conditions::{Conditions, ResultRow};
pub use error::{EvaluationError, ForecastError, ForecastShapeError, MeasureError, ReportError};
pub use figure::error::{FigureError, GoalCaseProblem};
pub use forecast::Forecast;
pub use forecaster::Forecaster;
pub use metric::stability::StabilityScores;
pub use moment::{Moment, MomentHypothesis, MomentWalker};
pub use protocol::{Protocol, UnknownProtocol};
pub use report::Report;
pub use scene::Scene;
pub use scores::Scores;
pub use training_curve::{EpochPoint, TrainingCurve};
