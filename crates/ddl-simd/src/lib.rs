#![doc = include_str!("../README.md")]

mod dispatch;
mod exp2;
mod lanes;
mod simd;

pub use dispatch::{Dispatch, InstructionSet};
pub use exp2::exp2_each;
pub use lanes::{DEPTH, LANES, Lanes};
pub use simd::{Floats, Kernel, Simd, TiledKernel, Vectors};
