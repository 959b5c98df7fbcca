#![doc = include_str!("../README.md")]
//!
//! A forecast without noise samples ([`Noise::Expected`]) uses the expectation of `L L^T` over the noise. With zero
//! noise instead, the forecast motion would be too slow. With [`StepRule::Bounded`] no step passes the goal. If the
//! goal can be reached at the pedestrian's top speed, no step is faster than that speed, and the last step ends on the
//! goal up to the rounding of `f32`. A [`WindowRollout`] carries the factors (a, b, c) of every step, with which the
//! path can be integrated again in `f64`.
//!
//! ## Propose endpoints
//!
//! [`ProposalNetwork`] is an ensemble of small perceptrons with attention over the neighbours. It reads one pedestrian
//! in the pedestrian's own frame (the last position is the origin, the heading is +x), and each member proposes K
//! endpoints. With earlier pedestrians of the place (`remembered`) a second attention reads these, and each member
//! proposes K more.
//!
//! ```rust
//! use ddl_network::{PedestrianView, ProposalConfig, ProposalNetwork, ProposeEndpoints as _};
//!
//! // A pedestrian at 1 m/s, and another 3 m ahead who comes the other way.
//! let walk = |speed: f64, x: f64| std::array::from_fn(|t| [x + 0.4 * speed * (t as f64 - 7.0), 0.0]);
//! let view = PedestrianView { own: walk(1.0, 0.0), neighbours: vec![walk(-1.2, 3.0)], remembered: vec![] };
//!
//! let config = ProposalConfig { members: 2, ends: 5, ..ProposalConfig::default() };
//! let network = ProposalNetwork::new(config, 1)?;
//! let proposed = network.propose(&[view])?.remove(0);
//! assert_eq!(proposed.endpoints.len(), 2 * 5); // metres ahead, metres to the left
//! assert!((proposed.weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
//! # Ok::<(), ddl_network::NetworkError>(())
//! ```
//!
//! ## Variants
//!
//! The rows of the paper's Table II are one network with two switches:
//!
//! | [`Variant`] | reads positions relative to | emits | forecast |
//! |---|---|---|---|
//! | `Full` | the goal | (a, b, c) | follows the dynamics to the goal |
//! | `NoGoalShift` | the last observed position | (a, b, c) | follows the dynamics to the goal |
//! | `NoDynamics` | the goal | (x, y) | goal + (x, y) |
//! | `Star` | the last observed position | (x, y) | last observed position + (x, y), without a goal |
//!
//! A backbone is written once, in the operations of a [`backend::Backend`]; [`MotionNetwork::with_backbone`] takes one
//! of your own.
//!
//! ## Shapes
//!
//! P: pedestrians of all windows of a batch, concatenated; N: pedestrians of one window; G and H: goals and hypotheses
//! per pedestrian. Positions are in metres, time steps 0.4 s apart.
//!
//! | | shape |
//! |---|---|
//! | goals, shares of [`ForecastWindows::forecast_windows`] | `[window][N][H or 1]`, `[window][N]` |
//! | [`WindowRollout`]: positions, factors | `[N][H][12]` |
//! | [`ForecastBatch::goals`] | `[G][P]`, G = H or 1 |
//! | [`ForecastBatch::noise`] | `[H or 1, 16]`, shared by all pedestrians |
//! | [`BatchRollout`]: positions, factors | `[12, H, P]`: each from the forecast position before it |
//! | [`backend::Backend::Tokens`] | `[B, P, width]`: B hypotheses, or time steps |
//! | [`PedestrianView`]: own, neighbours | `[8]`, `[any number][8]` |
//! | [`ProposedEndpoints`]: endpoints, weights | `[members K]` |
//!
//! ## Weights
//!
//! [`weights::save_weights`] writes a safetensors file, which holds only numbers, under a temporary name that is
//! renamed when complete. [`weights::load_weights`] refuses a file that is truncated or far too large, lacks a tensor,
//! has one of another shape or type, holds NaN or infinity, or differs from its SHA-256. It also refuses a file of
//! another [`weights::Origin`] (configuration, seed and training data). So it detects weights of another run even if
//! their shapes fit.
//!
//! ## Reproducibility
//!
//! The bits of a window's forecast do not depend on the other windows of the batch, their order, or the number of
//! rayon's threads. The same holds for the proposals of a pedestrian. They are computed in `f32` with the fastest
//! instructions of the machine: AVX-512 or AVX2 on x86-64, otherwise portable code. Between instruction sets results
//! agree up to rounding.
#![cfg_attr(not(feature = "training"), allow(dead_code, reason = "only training uses the backward passes"))]

pub mod backbone;
pub mod backend;
mod config;
mod device;
mod error;
mod forecast;
mod kernel;
pub mod proposal;
pub mod seed;
mod training_report;
pub mod weights;

pub use config::{
    BackboneKind, LearningRateSchedule, MemoryConfig, MemoryTraining, NetworkFrame, Objective, ProposalConfig,
    ProposalTraining, StarConfig, TrainingConfig, Variant,
};
pub use device::DeviceChoice;
pub use error::NetworkError;
pub use forecast::{
    BatchRollout, CrowdOrder, ForecastBatch, ForecastWindows, MotionNetwork, Noise, StepRule, WindowRollout,
    length_unit, motion_bounds, visibility,
};
pub use kernel::prepare_thread;
pub use proposal::{PedestrianView, ProposalExample, ProposalNetwork, ProposeEndpoints, ProposedEndpoints};
pub use training_report::{EpochReport, ProposalStep, StepReport};
