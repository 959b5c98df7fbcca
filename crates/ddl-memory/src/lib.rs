#![doc = include_str!("../README.md")]

mod error;
mod file;
mod memory;
mod memory_file;
mod piece;
mod place;
mod recall;
mod replay;
mod summary;
mod track;

pub use error::MemoryError;
pub use memory::SceneMemory;
pub use memory_file::{MemoryFile, Unsaved};
pub use place::{PlaceMemory, Refusal};
pub use replay::Playback;
pub use summary::MemorySummary;
