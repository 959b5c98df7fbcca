#![doc = include_str!("../README.md")]

mod attractor;
mod diffeomorphism;
mod error;
mod flow;
mod integrate;
mod lyapunov;
mod metric;
mod metric_source;
mod motion_bounds;
mod obstacle;
mod polar;
mod real;
mod rollout;
mod spectrum;
mod state;

pub use attractor::Attractor;
pub use diffeomorphism::{Chain, Diffeomorphism, LocalTranslation, Straightening};
pub use error::DynamicsError;
pub use flow::{AvoidingFlow, DiffeomorphicFlow, Flow, NaturalGradientFlow};
pub use integrate::{DormandPrince, Euler, Integrator, StableEuler, StableStep, StepLimit};
pub use lyapunov::{Bounded, CertifiedStep, LyapunovCertificate, MotionEvidence, Violation};
pub use metric::{CholeskyMetric, PUBLISHED_SIGMA};
pub use metric_source::{ArrivingSchedule, MetricSchedule, MetricSource};
pub use motion_bounds::{MotionBounds, StepTime};
pub use obstacle::{Ball, ObstacleSchedule, ObstacleSource};
pub use real::Real;
pub use rollout::{rollout, rollout_into};
pub use spectrum::EigenvalueRange;
pub use state::State;
