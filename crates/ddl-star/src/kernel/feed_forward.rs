//! Parts of the network computed without libtorch, so that what passes between two products stays in the cache.
//!
//! Matrices are cut into blocks of 32 numbers, padded with zeros. A computation is written once, as a
//! `Kernel`, for any `Simd`; `Dispatch::run` compiles it
//! for each instruction set and picks the one that was chosen. What is `unsafe` lies in one module.

mod block;
mod block_rows;
mod dropout;
mod feed_forward;
mod instruction_set;
mod portable;
mod product;
mod simd;
#[cfg(test)]
mod speed;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use dropout::Dropout;
pub use feed_forward::{FeedForward, Gradients};
pub use instruction_set::InstructionSet;

use block::{BLOCK, Block};
