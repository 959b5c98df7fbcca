//! The heavy parts of the network: only what is needed is computed, and what passes between two products stays in the cache.
//!
//! - [`encoder_layer`]: a whole encoder layer, made of
//!   - [`affine`]: projections, and [`add_norm`]: residual connection and normalisation;
//!   - [`among_pedestrians`]: attention of every pedestrian over those of its scene that it sees, as [`scenes`] has it;
//!   - [`over_memory`]: attention of the newest token over the remembered ones;
//!   - [`feed_forward`]: the feed-forward block;
//! - [`linear`]: an affine map between layers.
//!
//! A computation is written once, as a `Kernel`, with the arithmetic of any [`ddl_simd::Simd`], sixteen numbers at a time;
//! products of bf16 numbers are a second arithmetic, [`ddl_simd::Pairs`]. `ddl-simd` runs it with the fastest instructions
//! that the machine has. Results do not depend on the number of threads; instruction sets agree to rounding.

#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "lanes must stay in registers, and loops over them are of a known count"
)]

mod add_norm;
mod affine;
mod among_pedestrians;
mod buffer;
mod columns;
mod dropout;
mod encoder_layer;
mod feed_forward;
mod gelu;
mod heads;
mod linear;
mod over_memory;
mod scenes;
#[cfg(test)]
mod tests;
mod threads;

pub use buffer::Buffer;
pub(crate) use dropout::Dropout;
pub use encoder_layer::Sizes;
pub(crate) use encoder_layer::{Dropouts, EncoderKernel, Remembered};
pub(crate) use gelu::gelu;
pub(crate) use linear::LinearKernel;
pub use scenes::Scenes;
