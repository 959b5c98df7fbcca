//! Between tensors and the plain numbers that kernels take.

use crate::kernel::Buffer;
use tch::Tensor;

/// The numbers of a tensor, row by row.
pub(crate) fn numbers(tensor: &Tensor) -> Buffer {
    let mut numbers = Buffer::any(tensor.numel());
    let plain = tensor.detach().contiguous();
    plain.copy_data(&mut numbers, tensor.numel());
    numbers
}

/// A tensor of that shape.
pub(crate) fn tensor(numbers: &[f32], shape: &[i64]) -> Tensor {
    Tensor::from_slice(numbers).reshape(shape)
}
