//! The learned weights of a network: their names, initial values and files.

mod digest;
mod file;
mod half_precision;
mod layout;
mod learned;
mod origin;

pub use crate::kernel::Sizes;
pub use digest::{in_hex, tensors_digest};
pub use file::{StoredTensor, TensorData, find_tensor, load_weights, read_tensors, save_weights, write_tensors};
pub use half_precision::HalfTensor;
pub(crate) use layout::Initial;
pub use layout::{EncoderLayer, Layout, Linear, TensorLayout};
pub use learned::Weights;
pub use origin::Origin;
