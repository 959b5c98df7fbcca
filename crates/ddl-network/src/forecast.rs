//! Forecasts: from windows and goals to positions.

mod batch;
mod bounded_steps;
mod emission;
mod forecast_windows;
mod motion_bounds;
mod network;
mod one_step;
mod own_frame;
mod pass;
mod rollout;
mod rollout_state;
mod visibility;

pub use batch::{BatchRollout, CrowdOrder, ForecastBatch};
pub use forecast_windows::ForecastWindows;
pub use motion_bounds::motion_bounds;
pub use network::MotionNetwork;
pub use own_frame::length_unit;
pub use rollout::{Noise, StepRule, WindowRollout};
pub use visibility::visibility;
