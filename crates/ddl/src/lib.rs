#![doc = include_str!("../README.md")]
#![cfg_attr(
    not(feature = "torch"),
    allow(dead_code, reason = "training alone needs it")
)]

mod device;
mod error;
mod evaluation;
mod forecast;
mod goals;
mod model;
mod run;
mod training;
mod trust;

pub use ddl_data as data;
pub use ddl_dynamics as dynamics;
pub use ddl_eval as eval;
pub use ddl_goal as goal;
pub use ddl_memory as memory;
pub use ddl_network as network;
pub use ddl_report as report;
pub use ddl_softdtw as softdtw;
#[cfg(feature = "torch")]
pub use ddl_star as star;

pub use ddl_eval::{Forecast, Forecaster, Protocol};
pub use ddl_network::{DeviceChoice, Precision, Variant};
pub use device::{Device, cuda_status, prepare};
pub use error::DdlError;
pub use evaluation::baselines::measure_baselines;
pub use evaluation::comparison::{BestOfTwenty, Comparison, compare_on_validation};
pub use evaluation::evaluate::{Evaluation, EvaluationProgress, EvaluationRequest, evaluate};
pub use evaluation::goal_picture::goal_picture;
pub use evaluation::goals::{GoalErrors, GoalEvaluation, MeasuredGoals, evaluate_goals};
pub use evaluation::record::{is_evaluated, save_evaluation};
pub use evaluation::results::Results;
pub use evaluation::split::EvaluationSplit;
pub use evaluation::test_set::name_of;
pub use forecast::certified::{CertificateError, CertifiedForecast};
pub use forecast::clearance::Clearance;
pub use forecast::live::{LiveForecast, LiveForecaster};
pub use forecast::memory_file::MemoryFile;
pub use forecast::recording_player::RecordingPlayer;
pub use forecast::scenes::{LiveScenes, SceneBatch, SceneForecast};
pub use forecast::watched_place::{OtherPlace, WatchedPlace};
pub use goals::model::GoalModel;
pub use goals::recipe::{GoalRecipe, ProposalRecipe};
pub use goals::remembering::Remembering;
pub use model::builtin::BuiltinModel;
pub use model::ddl::Ddl;
pub use model::source::ModelSource;
pub use run::config::{FORMAT, RunConfig, TrainingData};
pub use run::directory::{RunDirectory, write_atomically};
pub use run::lock::RunLock;
pub use run::starting_model::{StartingModel, goals_trained_further, training_further};
pub use run::track_units::TrackUnits;
pub use run::training_data::fold_of;
pub use run::validation_part::ValidationPart;
pub use training::best_epoch::best_epoch;
pub use training::{TrainingProgress, TrainingRequest, TrainingStage, TrainingStep, train};
pub use trust::calibration::Calibration;
pub use trust::familiarity::UNFAMILIAR;

/// The examples of the guide, run as those of this documentation are.
#[cfg(doctest)]
mod guide {
    #[doc = include_str!("../../../docs/rust.md")]
    mod rust {}
    #[doc = include_str!("../../../docs/extending.md")]
    mod extending {}
}
