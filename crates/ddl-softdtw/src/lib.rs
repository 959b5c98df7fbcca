#![doc = include_str!("../README.md")]

mod batch;
mod blocks;
mod cost;
mod error;
mod gradient;
mod lanes;
mod range;
mod recursion;
mod refine;
mod search;
mod select;
mod sieve;
mod sliding;
mod softmin;
mod value;

pub use batch::{BatchGradients, SoftDtwBatch};
pub use cost::Cost;
pub use error::{SearchError, SequenceRole, SoftDtwError};
pub use lanes::InstructionSet;
pub use search::{Neighbour, SearchIndex};
pub use sliding::{SlidingError, SlidingIndex, WindowNeighbour};
pub use value::SoftDtw;
