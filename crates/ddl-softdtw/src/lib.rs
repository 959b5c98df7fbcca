#![doc = include_str!("../README.md")]

mod alignment;
mod band;
mod batch;
mod blocks;
mod cost;
mod decision;
mod error;
mod exp2;
mod gradient;
mod grid;
mod log_domain;
mod range;
mod recursion;
mod refine;
mod scalar;
mod search;
mod select;
mod sieve;
mod sliding;
mod softmin;
mod value;
mod wavefront;
mod weight;

pub use band::Band;
pub use batch::{BatchGradients, SoftDtwBatch};
pub use cost::Cost;
pub use ddl_simd::InstructionSet;
pub use decision::Neighbour;
pub use error::{SearchError, SequenceRole, SoftDtwError};
pub use scalar::Scalar;
pub use search::SearchIndex;
pub use sliding::{SlidingError, SlidingIndex, WindowNeighbour};
pub use value::SoftDtw;
