//! What was observed of a pedestrian at a moment: an estimate from the rows of its track up to then.

mod estimate;
mod motion;
mod noise;
mod track;

pub(crate) use estimate::ON_STEP;
pub use noise::RecordingNoise;
pub use track::Arrival;
pub(crate) use track::ObservedTrack;

#[cfg(test)]
mod tests;
