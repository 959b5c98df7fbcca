#![doc = include_str!("../README.md")]

mod error;
mod file;
mod memory;
mod piece;
mod recall;
mod replay;
mod summary;
mod track;

pub use error::MemoryError;
pub use memory::SceneMemory;
pub use recall::MAX_SQUARED_DISTANCE;
pub use replay::Playback;
pub use summary::MemorySummary;
pub use track::{MAX_ABSENCE_STEPS, MAX_RUNS};
