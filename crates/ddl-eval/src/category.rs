//! Categories of pedestrians: the [`MotionKind`] of each, and the [`interaction`] of two.
//!
//! They read the future. They group results and choose examples after the forecasts are made; forecasts must not depend
//! on them.

pub mod interaction;
mod motion_kind;

pub use motion_kind::MotionKind;
