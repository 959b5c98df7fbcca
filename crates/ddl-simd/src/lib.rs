#![doc = include_str!("../README.md")]

#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
mod amx;
mod block;
mod dispatch;
mod emulated;
mod exp2;
mod lanes;
mod matrix;
mod pairs;
mod portable;
mod register;
mod simd;
mod sixteen;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use block::{BLOCK, Block, Panel, transpose};
pub use dispatch::{Dispatch, InstructionSet, MatrixDispatch, PairDispatch};
pub use exp2::{
    COST_LIMIT, COST_LIMIT_64, EXP2_ERROR, EXP2_ERROR_64, EXP2_PARTS_ERROR, wide_exp2_each, wide_exp2_parts,
};
pub use lanes::{DEPTH, HALF, HalfQuad, LANES, Lanes, Quad, WIDE_LANES, ZERO_QUAD};
pub use matrix::{LeftFactor, Line, MatrixKernel, MatrixUnit, Pieces, RightFactor, Start, UnitFloats};
pub use pairs::{Floats, PairKernel, Pairs};
pub use register::{Register, RegisterKernel};
pub use simd::{Kernel, Simd, Tile, TiledKernel, Vectors};
