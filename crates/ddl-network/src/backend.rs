//! The operations that a backbone is written in. [`KernelBackend`] computes them on the CPU in `f32`, forwards and
//! backwards; the crate `ddl-star` implements [`Backend`] on libtorch.

mod kernels;
mod operations;
mod rows;

pub use crate::kernel::{Buffer, Scenes};
pub use kernels::{KernelBackend, Kernels, RowKeyValues, VisibleScenes};
pub use operations::{Backend, Memory, Mode};
pub use rows::Rows;
