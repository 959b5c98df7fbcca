#![doc = include_str!("../README.md")]

mod error;
mod file;
mod forget;
mod limits;
mod memory;
mod piece;
mod recall;
mod summary;
mod track;

pub use error::MemoryError;
pub use memory::SceneMemory;
pub use recall::{Example, FARTHEST, Recalled};
pub use summary::MemorySummary;
pub use track::{LONGEST_ABSENCE, MOST_PIECES};
