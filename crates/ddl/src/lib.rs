#![doc = include_str!("../README.md")]
#![cfg_attr(
    not(feature = "torch"),
    allow(dead_code, reason = "training alone needs it")
)]

mod baselines;
mod builtin_model;
mod calibration;
mod certified_forecast;
mod clearance;
mod comparison;
mod device;
mod early_stopping;
mod enough_weights;
mod error;
mod evaluation;
mod evaluation_record;
mod experts;
mod familiarity;
mod goal_evaluation;
mod goal_model;
mod goal_picture;
mod goal_recipe;
mod goals;
mod live;
mod machine;
mod manner;
mod model;
mod model_source;
mod network_forecast;
mod packed_model;
mod published;
mod reach;
mod result_rows;
mod results;
mod run_config;
mod run_directory;
mod run_lock;
mod sha256;
mod starting_model;
mod straight_lines;
mod test_set;
mod track_units;
mod training;
mod training_words;
mod validation_part;
mod views;
mod walk;

pub use ddl_data as data;
pub use ddl_dynamics as dynamics;
pub use ddl_eval as eval;
pub use ddl_goal as goal;
pub use ddl_network as network;
pub use ddl_report as report;
pub use ddl_softdtw as softdtw;
#[cfg(feature = "torch")]
pub use ddl_star as star;

pub use baselines::measure_baselines;
pub use builtin_model::BuiltinModel;
pub use calibration::Calibration;
pub use certified_forecast::{CertificateError, CertifiedForecast};
pub use clearance::Clearance;
pub use comparison::{BestOfTwenty, Comparison, compare_on_validation};
pub use ddl_eval::{Forecast, Forecaster, Protocol};
pub use ddl_network::{DeviceChoice, Precision, Variant};
pub use device::Device;
pub use early_stopping::best_epoch;
pub use error::DdlError;
pub use evaluation::{
    Evaluation, EvaluationProgress, EvaluationRequest, EvaluationSplit, evaluate,
};
pub use evaluation_record::{is_evaluated, save_evaluation};
pub use familiarity::UNFAMILIAR;
pub use goal_evaluation::{GoalErrors, GoalEvaluation, MeasuredGoals, evaluate_goals};
pub use goal_model::GoalModel;
pub use goal_picture::goal_picture;
pub use goal_recipe::{GoalRecipe, ProposalRecipe};
pub use live::{LiveForecast, LiveForecaster};
pub use machine::{cuda_status, prepare};
pub use model::Ddl;
pub use model_source::ModelSource;
pub use results::Results;
pub use run_config::{FORMAT, RunConfig, TrainingData};
pub use run_directory::{RunDirectory, write_atomically};
pub use starting_model::{StartingModel, goals_trained_further, training_further};
pub use test_set::name_of;
pub use track_units::TrackUnits;
pub use training::{
    TrainingProgress, TrainingRequest, TrainingStage, TrainingStep, fold_of, train,
};
pub use validation_part::ValidationPart;

/// The examples of the guide, run as those of this documentation are.
#[cfg(doctest)]
mod guide {
    #[doc = include_str!("../../../docs/rust.md")]
    mod rust {}
    #[doc = include_str!("../../../docs/extending.md")]
    mod extending {}
}
