//! The heavy parts of the network, computed without libtorch: only what is needed, and what passes between two products
//! stays in the cache.
//!
//! - [`encoder_layer`]: a whole encoder layer, made of
//!   - [`affine`]: projections, and [`add_norm`]: residual connection and normalisation;
//!   - [`among_walkers`]: attention of every walker over those of its scene that it sees, as [`scenes`] has it;
//!   - [`over_memory`]: attention of the newest token over the remembered ones;
//!   - [`feed_forward`]: the feed-forward block;
//! - [`linear`]: an affine map between layers.
//!
//! A computation is written once, as a `Kernel`, with the arithmetic of any [`simd::Simd`], sixteen numbers at a time.
//! [`instruction_set`] runs it with the fastest instructions that the machine has: those of `x86`, or what the compiler
//! makes of [`portable`] code. What is `unsafe` lies in `x86` alone.
//!
//! Products of bf16 numbers, which the feed-forward block can be asked for, are a second arithmetic, [`simd::Pairs`], with
//! instructions of its own.
//!
//! All results are the same for every number of threads; between instruction sets they agree to rounding.

mod add_norm;
mod affine;
mod among_walkers;
mod buffer;
mod columns;
mod dropout;
mod encoder_layer;
mod exp2;
mod feed_forward;
mod heads;
mod instruction_set;
mod lanes;
mod linear;
mod over_memory;
mod portable;
mod scenes;
mod simd;
#[cfg(test)]
mod tests;
mod threads;
#[cfg(target_arch = "x86_64")]
mod x86;

/// Whether the machine has instructions for products of bf16 numbers.
pub(crate) fn has_bf16_instructions() -> bool {
    instruction_set::PairDispatch::detect().is_native()
}

pub(crate) use buffer::Buffer;
pub(crate) use dropout::Dropout;
pub(crate) use encoder_layer::{Dropouts, EncoderLayer, Remembered, Sizes};
pub(crate) use linear::Linear;
pub(crate) use scenes::{Frames, Scenes};
