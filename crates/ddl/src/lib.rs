#![doc = include_str!("../README.md")]
//!
//! ## Train and measure
//!
//! ```rust,no_run
//! use ddl::data::Dataset;
//! use ddl::network::{StarConfig, TrainingConfig};
//! use ddl::report::Report;
//! use ddl::{
//!     Ddl, DeviceChoice, EvaluationRequest, Split, GoalRecipe, Protocol, RunDirectory,
//!     TrainingRequest, TrainingStage, Variant,
//! };
//! use std::ops::ControlFlow;
//!
//! ddl::prepare(DeviceChoice::Cpu, None)?;
//! // Simulated crowds need no files; `Dataset::load` reads the ETH/UCY recordings.
//! let dataset = Dataset::simulated(1);
//!
//! let request = TrainingRequest {
//!     fold: "plaza".to_owned(),
//!     star: StarConfig::published(Variant::Full),
//!     training: TrainingConfig { epochs: 4, ..TrainingConfig::published() },
//!     validation: 0.0,
//!     validation_recordings: Vec::new(),
//!     goals: GoalRecipe::proposed(1),
//!     patience: None,
//!     from: None,
//!     units: None,
//!     last_epoch_only: false,
//!     until: TrainingStage::Network,
//!     out: RunDirectory::new("runs/plaza"),
//!     device: DeviceChoice::Cpu,
//!     commit: "unknown".to_owned(),
//! };
//! ddl::train(&request, &dataset, |now| {
//!     println!("{} of {} steps", now.steps.0, now.steps.1);
//!     ControlFlow::Continue(()) // `Break` saves and stops; the same call resumes later
//! })?;
//!
//! let model = Ddl::load("runs/plaza".as_ref(), DeviceChoice::Cpu)?;
//! let request = EvaluationRequest {
//!     protocols: vec![Protocol::Fair, Protocol::Single],
//!     on: Split::Test,
//!     validation_recordings: Vec::new(),
//!     test_pedestrians: Some(500), // a seeded part of the windows; the report says so
//!     commit: "unknown".to_owned(),
//! };
//! let evaluation = ddl::evaluate(&model, &dataset, &request, |_| ControlFlow::Continue(()))?;
//! println!("{}", Report::new("Plaza", evaluation.rows)?.to_markdown());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The rows hold the model and the baselines, each with its conditions of measurement. The protocol `fair` adds rows
//! for the model without the expert library and for straight lines at constant speed to the same goals. For a network
//! trained on single steps it also adds a row with plain Euler steps. The protocol `single` adds a row for the path
//! that the network shapes. Under `fair` and `single` the future is removed from the windows before the model is
//! called.
//!
//! ## Guarantees
//!
//! - Every hypothesis of a variant with dynamics approaches its goal at every step: the network shapes the metric,
//!   [`dynamics::StableEuler`] integrates in `f64`, and [`Ddl::forecast_certified`] returns the certificates. The
//!   protocol `published` integrates with plain Euler steps, which overshoot; it exists to reproduce published numbers.
//! - A run is one directory. Every file is written under a temporary name and renamed. A run refuses to resume under
//!   another configuration. A resumed run ends with the same weights, bit for bit, as an uninterrupted one on the same
//!   machine with the same number of threads.
//! - Files are checked when they are loaded. A packed model carries the SHA-256 of its configuration and weights.
//!   Truncated, mismatched or non-finite files are errors that name the file and the problem.
//! - A model reads only the 8 observed positions. Its hypotheses belong to the goals of the estimator and carry their
//!   weights, which sum to 1 for each pedestrian; the variant without goals (`star`) has 20 equally likely samples.
#![cfg_attr(not(feature = "torch"), allow(dead_code, reason = "only training needs it"))]

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

pub use ddl_core::{AdaptiveRegions, Disc, Forecast, ForecastError, Forecaster, RegionTable};
pub use ddl_eval::Protocol;
pub use ddl_network::{DeviceChoice, Variant};
pub use device::{Device, cuda_status, prepare};
pub use error::DdlError;
pub use evaluation::baselines::measure_baselines;
pub use evaluation::comparison::{BestOf20Errors, Comparison, compare_on_validation};
pub use evaluation::evaluate::{Evaluation, EvaluationProgress, EvaluationRequest, evaluate};
pub use evaluation::goal_picture::goal_picture;
pub use evaluation::goals::{GoalErrors, GoalEvaluation, MeasuredGoals, evaluate_goals};
pub use evaluation::record::{is_evaluated, save_evaluation};
pub use evaluation::results::Results;
pub use evaluation::split::Split;
pub use evaluation::test_set::test_set_name;
pub use forecast::certified::{CertificateError, CertifiedForecast};
pub use forecast::clearance::Clearance;
pub use forecast::live::{LiveForecast, LiveForecaster};
pub use forecast::memory_file::MemoryFile;
pub use forecast::place_memory::{MemoryMismatch, PlaceMemory};
pub use forecast::recording_player::RecordingPlayer;
pub use forecast::scenes::{LiveScenes, SceneBatch, SceneForecast};
pub use goals::model::GoalModel;
pub use goals::recipe::{GoalRecipe, ProposalRecipe};
pub use goals::remembering::Remembering;
pub use model::builtin::BuiltinModel;
pub use model::ddl::Ddl;
pub use model::source::ModelSource;
pub use run::config::{FORMAT, RunConfig, TrainingData};
pub use run::directory::{RunDirectory, write_atomically};
pub use run::lock::RunLock;
pub use run::starting_model::{InitialModel, fine_tuning_config, fine_tuning_goal_recipe};
pub use run::track_units::TrackUnits;
pub use run::training_data::fold_by_name;
pub use run::validation_part::ValidationPart;
pub use training::best_epoch::best_epoch;
pub use training::{TrainingProgress, TrainingRequest, TrainingStage, TrainingStep, train};
pub use trust::calibration::Calibration;
pub use trust::familiarity::UNFAMILIAR_THRESHOLD;

/// The examples of the guide, run as documentation tests.
#[cfg(doctest)]
mod guide {
    #[doc = include_str!("../../../docs/rust.md")]
    mod rust {}
    #[doc = include_str!("../../../docs/extending.md")]
    mod extending {}
}
