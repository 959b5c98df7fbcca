#![doc = include_str!("../README.md")]

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
mod softmin;
mod value;

pub use cost::Cost;
pub use error::{SearchError, SequenceRole, SoftDtwError};
pub use lanes::InstructionSet;
pub use search::{Neighbour, SearchIndex};
pub use value::SoftDtw;
