//! What was observed of a pedestrian at a moment: an estimate from the rows of its track up to then.

mod doubt;
mod estimate;
mod exchange;
mod misfit;
mod motion;
mod noise;
mod track;

pub(crate) use estimate::{ON_STEP, ObservedPositions};
pub(crate) use exchange::{Exchange, exchanges};
pub use misfit::{Misfit, MisfitTreatment};
pub use noise::RecordingNoise;
pub(crate) use track::{LONGEST_GAP, ObservedTrack, TimedPosition};

#[cfg(test)]
mod tests;
