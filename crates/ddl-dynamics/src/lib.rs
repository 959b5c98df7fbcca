#![doc = include_str!("../README.md")]
//!
//! ## A hand that reaches for a cup
//!
//! ```rust
//! use ddl_dynamics::{
//!     Attractor, CholeskyMetric, LyapunovCertificate, NaturalGradientFlow, StableEuler, rollout,
//! };
//! use ddl_dynamics::nalgebra::{Matrix3, Vector3};
//!
//! let cup = Attractor::new(Vector3::new(0.6_f32, 0.1, 0.3))?;
//! // Slow in height, quick across; the hand swings out to the left on its way.
//! let factor = Matrix3::new(
//!     0.8, 0.0, 0.0,
//!     0.3, 0.7, 0.0,
//!     0.0, 0.1, 0.4,
//! );
//! let metric = CholeskyMetric::new(factor, 0.01)?;
//! let reach = NaturalGradientFlow::new(cup, metric);
//! let path = rollout(&reach, &StableEuler, Vector3::zeros(), 0.05, 200)?;
//! assert_eq!(path[200], *cup.goal());
//!
//! // The longest possible duration: distance over the smallest eigenvalue (of the continuous flow).
//! let slowest = metric.eigenvalue_range().smallest;
//! println!("{:.1} s", cup.distance(&path[0]) / slowest);
//! assert!(LyapunovCertificate::of_rollout(&reach, &path, 0.05)?.verify().is_ok());
//! # Ok::<(), ddl_dynamics::DynamicsError>(())
//! ```
//!
//! ## What is guaranteed, and when
//!
//! | | guaranteed | condition |
//! |---|---|---|
//! | continuous time | `Phi` falls at `u^T P u`, at least `lambda_min`; goal after at most `Phi(0) / lambda_min` seconds | `P` positive definite: every [`CholeskyMetric`] |
//! | [`Euler`] | `Phi` falls in a step | only if `dt < 2 Phi u^T P u / \|P u\|^2`: never near the goal |
//! | [`StableEuler`] | `Phi`, as computed, falls in every step until it is 0; then rest | none: any finite input, `f32` or `f64` |
//! | [`StableEuler`] | `Phi <= tolerance` in a bounded number of steps | eigenvalues within `[m, M]`, `m > 0` |
//! | [`LyapunovCertificate`] | names the first step of a path that violates the decrease | none: any path |
//!
//! The smallest eigenvalue `sigma` of the paper, 1e-8, is lost when `P` is formed in `f32`; here `P` is applied through
//! its factor and never formed. Certificates are `serde` types: with the feature `float_roundtrip` of
//! `serde_json` they keep every bit.

mod attractor;
mod error;
mod flow;
mod integrate;
mod lyapunov;
mod metric;
mod metric_source;
mod motion_bounds;
mod polar;
mod real;
mod rollout;
mod spectrum;
mod state;

pub use nalgebra;

pub use attractor::Attractor;
pub use error::DynamicsError;
pub use flow::NaturalGradientFlow;
pub use integrate::{Euler, Integrator, StableEuler};
pub use lyapunov::{Bounded, CertifiedStep, LyapunovCertificate, MotionEvidence, Violation};
pub use metric::{CholeskyMetric, PUBLISHED_SIGMA};
pub use metric_source::{MetricSchedule, MetricSource, arriving_schedule};
pub use motion_bounds::{MotionBounds, StepTime};
pub use real::Real;
pub use rollout::{rollout, rollout_into};
pub use spectrum::EigenvalueRange;
pub use state::State;
