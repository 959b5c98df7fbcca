//! Plain numbers as tensors, and back.

use crate::StarError;
use tch::{Device, Kind, Tensor};

/// A tensor of numbers in row-major order, in that precision on that device.
pub(crate) fn tensor(numbers: &[f64], shape: &[i64], (kind, device): (Kind, Device)) -> Result<Tensor, StarError> {
    let tensor = Tensor::f_from_slice(numbers)?.f_reshape(shape)?;
    Ok(tensor.f_to_kind(kind)?.f_to_device(device)?)
}

/// The numbers of a tensor in row-major order.
pub(crate) fn numbers(tensor: &Tensor) -> Result<Vec<f64>, StarError> {
    let here = tensor.f_to_device(Device::Cpu)?.f_to_kind(Kind::Double)?;
    Ok(Vec::try_from(here.f_contiguous()?.f_reshape([-1])?)?)
}
