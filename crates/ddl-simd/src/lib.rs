#![doc = include_str!("../README.md")]

mod dispatch;
mod exp2;
mod lanes;
mod portable;
mod register;
mod simd;
mod sixteen;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use dispatch::{Dispatch, InstructionSet};
pub use exp2::{
    COST_LIMIT, COST_LIMIT_64, EXP2_ERROR, EXP2_ERROR_64, EXP2_PARTS_ERROR, wide_exp2_each, wide_exp2_parts,
};
pub use lanes::{DEPTH, HALF, HalfQuad, LANES, Lanes, Quad, WIDE_LANES, ZERO_QUAD};
pub use register::{Register, RegisterKernel};
pub use simd::{Kernel, Simd, Tile, TiledKernel, Vectors};
