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
pub use replay::Playback;
pub use summary::MemorySummary;
