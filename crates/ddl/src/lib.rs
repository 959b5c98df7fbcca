#![doc = include_str!("../README.md")]
#![cfg_attr(all(feature = "report", feature = "training"), doc = include_str!("train_and_measure.md"))]
//!
//! ## Guarantees
//!
//! - Every hypothesis of a variant with dynamics approaches its goal at every step: the network shapes the metric,
//!   [`dynamics::StableEuler`] integrates in `f64`, and a [`Request`] with certificates returns the evidence. The
//!   protocol `published` integrates with plain Euler steps, which overshoot; it exists to reproduce published numbers.
//! - A run is one directory. Every file is written under a temporary name and renamed. A run refuses to resume under
//!   another configuration. A resumed run ends with the same weights, bit for bit, as an uninterrupted one on the same
//!   machine with the same number of threads.
//! - Files are checked when they are loaded. A packed model carries the SHA-256 of its configuration and weights.
//!   Truncated, mismatched or non-finite files are errors that name the file and the problem.
//! - A model reads only the 8 observed positions. Its hypotheses belong to the goals of the estimator and carry their
//!   weights, which sum to 1 for each pedestrian; the variant without goals (`star`) has 20 equally likely samples.
#![cfg_attr(
    not(all(feature = "report", feature = "torch")),
    allow(dead_code, reason = "only training or evaluation needs it")
)]

mod device;
mod error;
#[cfg(feature = "report")]
mod evaluation;
mod forecast;
mod goals;
mod live;
mod model;
mod note;
mod run;
mod tracks;
#[cfg(feature = "training")]
mod training;
mod trust;
#[cfg(any(feature = "report", feature = "torch"))]
mod windows;

pub use ddl_dynamics as dynamics;
#[cfg(feature = "report")]
pub use ddl_eval as eval;
pub use ddl_goal as goal;
pub use ddl_memory as memory;
pub use ddl_network as network;
#[cfg(feature = "report")]
pub use ddl_report as report;
pub use ddl_scene as scene;
pub use ddl_softdtw as softdtw;
#[cfg(feature = "torch")]
pub use ddl_star as star;

pub use ddl_core::WorkDone;
pub use ddl_core::{
    AdaptiveRegions, Disc, Forecast, ForecastError, Forecaster, Holding, Pace, RegionTable, Spread, WeightedGoals,
};
pub use ddl_core::{Setting, word_settings};
pub use ddl_network::{DeviceChoice, Variant};
pub use device::{cuda_status, prepare, thread_pool};
pub use error::{DdlError, with_causes};
pub use forecast::answer::Answer;
pub use forecast::certified::CertificateError;
pub use forecast::joint::GivenPlan;
pub use forecast::request::{Motions, Request};
pub use goals::model::GoalModel;
#[cfg(feature = "files")]
pub use goals::remembering::Remembering;
pub use live::memory_files::{SessionMemory, file_stem};
pub use live::session::{FrameAnswer, Session};
pub use live::waiting::{SceneBatch, SceneWindows, WaitingWindows};
pub use model::ddl::Ddl;
pub use note::{MisfitNote, Note};
pub use run::builtin_model::BuiltinModel;
pub use run::config::{FORMAT, RunConfig, TrainingData};
pub use run::directory::{RunDirectory, write_atomically};
#[cfg(feature = "files")]
pub use run::few_recordings::starting_model;
#[cfg(feature = "files")]
pub use run::folds::fold_by_name;
pub use run::goal_recipe::{GoalRecipe, ProposalRecipe};
pub use run::lock::RunLock;
pub use run::model_source::ModelSource;
pub use run::starting_model::{InitialModel, fine_tuning_config, fine_tuning_goal_recipe};
pub use run::track_units::TrackUnits;
#[cfg(feature = "files")]
pub use run::validation_part::ValidationPart;
#[cfg(feature = "files")]
pub use tracks::csv_table::{csv_table, table_metres, table_share};
pub use tracks::json_lines::json_lines;
pub use tracks::moment::Moment;
pub use tracks::observed::{NobodyObserved, ObservedTracks, in_frames, misfits_of, noise, steps_in_words};
pub use tracks::past::ObservedPast;
pub use tracks::timed::TimedRecording;
pub use tracks::unfamiliar::UnfamiliarMotions;
pub use tracks::wanted_regions::WantedRegions;
pub use tracks::windows::{OutOfGap, WindowOptions};
pub use trust::calibration::region_table;
pub use trust::familiarity::UNFAMILIAR_THRESHOLD;

#[cfg(any(feature = "report", feature = "torch"))]
pub use windows::test_set::{Split, test_set_name};

/// Tracks and windows: the types of `ddl-core`, and the recordings and streams of `ddl-data`.
pub mod data {
    pub use ddl_core::{
        COORDINATE_LIMIT, FRAME_LIMIT, HORIZON, Numbering, OBSERVED, ObservationQuality, PedestrianId, PedestrianName,
        PedestrianNames, Position, RememberedTrack, Rotation, SpatialIndex, TIME_STEP, WINDOW, Window, WindowError,
        between, distance, remove_temporary_files, write_atomically, write_atomically_with,
    };
    pub use ddl_data::*;
}

/// What the feature `report` adds.
#[cfg(feature = "report")]
mod with_report {
    pub use crate::evaluation::comparison::{BestOf20Errors, Comparison, compare_on_validation};
    pub use crate::evaluation::evaluate::{Evaluation, EvaluationProgress, EvaluationRequest, evaluate};
    pub use crate::evaluation::goals::{GoalErrors, GoalEvaluation, evaluate_goals};
    pub use crate::evaluation::record::{is_evaluated, save_evaluation};
    pub use crate::evaluation::results::Results;
    pub use crate::live::recording_player::RecordingPlayer;
    pub use ddl_eval::Protocol;
}
#[cfg(feature = "report")]
pub use with_report::*;

/// What the feature `training` adds.
#[cfg(feature = "training")]
mod with_training {
    pub use crate::training::best_epoch::best_epoch;
    pub use crate::training::request::{TrainingProgress, TrainingRequest, TrainingStage, TrainingStep};
    pub use crate::training::train;
}
#[cfg(feature = "training")]
pub use with_training::*;

/// The examples of the guide, run as documentation tests.
#[cfg(all(doctest, feature = "report"))]
mod guide {
    #[doc = include_str!("../../../docs/rust.md")]
    mod rust {}
    #[doc = include_str!("../../../docs/extending.md")]
    mod extending {}
}
