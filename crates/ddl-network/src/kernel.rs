//! The expensive computations of the network. Each is written once, as a `Kernel` over any [`ddl_simd::Simd`],
//! and runs with the fastest instructions of the processor. Results do not depend on the number of
//! threads. Results of different instruction sets agree up to rounding.

#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "lanes must stay in registers, and loops over them are of a known count"
)]

mod add_norm;
mod affine;
mod buffer;
mod columns;
mod dropout;
mod encoder_layer;
mod feed_forward;
mod gelu;
mod heads;
mod linear;
mod product;
mod quads;
mod scenes;
mod spatial_attention;
mod temporal_attention;
#[cfg(test)]
mod tests;
mod threads;

pub use buffer::Buffer;
pub(crate) use buffer::{KeepBuffers, add_to};
pub(crate) use dropout::Dropout;
pub use encoder_layer::Sizes;
pub(crate) use encoder_layer::{CachedKeyValues, Dropouts, EncoderKernel};
pub(crate) use gelu::gelu;
pub(crate) use heads::HEAD_WIDTH;
pub(crate) use linear::LinearKernel;
pub use scenes::Scenes;

/// Makes what a thread keeps between computations, so that its first job need not. A thread of a pool may get that job
/// long after the others.
pub fn prepare_thread() {
    buffer::prepare_thread();
    spatial_attention::prepare_thread();
}
