#![doc = include_str!("../README.md")]

mod dispatch;
mod exp2;
mod lanes;
mod simd;

pub use dispatch::{Dispatch, InstructionSet};
pub use exp2::exp2_each;
pub use lanes::{DEPTH, HALF, HalfQuad, LANES, Lanes, Quad, ZERO_QUAD};
pub use simd::{Bits, Floats, Kernel, Simd, Tile, TiledKernel, Vectors};
