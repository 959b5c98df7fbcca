//! Plain numbers as tensors, and back.

use crate::StarError;
use tch::{Device, Kind, Tensor};

/// A tensor of numbers in row-major order, in that precision on that device.
pub(crate) fn tensor(numbers: &[f64], shape: &[i64], (kind, device): (Kind, Device)) -> Result<Tensor, StarError> {
    Ok(Tensor::f_from_slice(numbers)?.f_reshape(shape)?.f_to_kind(kind)?.f_to_device(device)?)
}

/// The numbers of a tensor in row-major order, in groups of N, which divides their number.
pub(crate) fn arrays<const N: usize>(tensor: &Tensor) -> Result<Vec<[f64; N]>, StarError> {
    let numbers = tensor.f_to_kind(Kind::Double)?.f_contiguous()?;
    let mut arrays = vec![[0.0; N]; numbers.numel() / N];
    numbers.f_copy_data(arrays.as_flattened_mut(), numbers.numel())?;
    Ok(arrays)
}
