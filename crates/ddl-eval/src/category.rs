//! Categories of pedestrians: the [`MotionKind`] of each.
//!
//! It reads the future. It groups results after the forecasts are made; forecasts must not depend on it.

mod motion_kind;

pub use motion_kind::MotionKind;
