//! The steps of a simulation.

use crate::TIME_STEP;

/// Raw frames in one step, as in most real recordings.
pub(super) const FRAME_STEP: i64 = 10;
/// Integration steps in one step of 0.4 s.
pub(super) const SUBSTEPS: i64 = 8;
/// One integration step (s).
pub(super) const DT: f64 = TIME_STEP / SUBSTEPS as f64;
