#![doc = include_str!("../README.md")]

mod arithmetic;
mod attention;
mod batch;
mod checkpoint;
mod config;
mod device;
mod draws;
mod dropout;
mod emission;
mod encoder_layer;
mod error;
mod flow;
mod forecast;
mod gate;
mod kernel;
mod layers;
mod loss;
mod neighbours;
mod numbers;
mod optimizer;
mod origin;
mod packed;
mod packing;
mod parameters;
mod pass;
mod precision;
mod prepared;
mod proposal;
mod remembered;
mod rollout;
mod scene_means;
mod schedule;
mod seed;
mod shared_weights;
mod spatial;
mod star;
mod tape;
mod temporal;
mod tokens;
mod train;
mod training_config;
mod training_report;
mod yardstick;

pub use batch::SceneBatch;
pub use checkpoint::{load_parameters, save_parameters};
pub use config::{StarConfig, Variant};
pub use device::{ComputeDevice, DeviceChoice, LIBTORCH_VERSION, set_threads};
pub use emission::NoiseInput;
pub use error::StarError;
pub use flow::{FlowConstants, StepRule, natural_gradient_step};
pub use forecast::{Noise, WindowRollout};
pub use layers::Mode;
pub use loss::mean_squared_distance;
pub use origin::Origin;
pub use parameters::Parameters;
pub use precision::Precision;
pub use proposal::{
    ProposalConfig, ProposalExample, ProposalNetwork, ProposalStep, ProposalTrainer,
    ProposalTraining, ProposedEnds, WalkerView,
};
pub use rollout::Rollout;
pub use star::StarNetwork;
pub use train::Trainer;
pub use training_config::{LearningRateSchedule, TrainingConfig};
pub use training_report::{EpochReport, StepReport};
pub use yardstick::MatrixProduct;
