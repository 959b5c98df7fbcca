//! The learned tensors, by name and in order.

use crate::StarError;
#[cfg(test)]
use ddl_network::weights::TensorLayout;
use ddl_network::weights::{Layout, Weights};
use std::sync::Arc;
use tch::{Device, Kind, Tensor};

/// The learned tensors of a network, in the order of its [`Layout`].
///
/// All of them are views into one flat vector, so that the optimiser, gradient clipping and saved states work on a
/// single tensor.
#[derive(Debug)]
pub struct Parameters {
    layout: Arc<Layout>,
    pub(crate) tensors: Vec<Tensor>,
    /// All learned parameters as one vector that shares its memory with the tensors.
    pub(crate) flat: Tensor,
}

/// Of the learned tensors, and of others.
type Gradients = (Vec<Option<Tensor>>, Vec<Option<Tensor>>);

impl Parameters {
    pub(crate) fn new(layout: Layout, initial: &[f64], device: Device, kind: Kind) -> Self {
        let _guard = tch::no_grad_guard();
        let flat = Tensor::from_slice(initial).to_kind(kind).to_device(device);
        let tensors = layout
            .tensors()
            .iter()
            .map(|tensor| {
                let span = tensor.span();
                let shape: Vec<i64> = tensor.shape().iter().map(|&size| size as i64).collect();
                let view = flat.narrow(0, span.start as i64, span.len() as i64).view(shape.as_slice());
                let mut learned = view.copy().set_requires_grad(true);
                learned.set_data(&view);
                learned
            })
            .collect();
        Self { layout: Arc::new(layout), tensors, flat }
    }

    /// Names, shapes and places.
    pub fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }

    /// Names and tensors, in order.
    #[cfg(test)]
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&str, &Tensor)> {
        self.layout.tensors().iter().map(TensorLayout::name).zip(&self.tensors)
    }

    /// The tensor of that name.
    #[cfg(test)]
    pub(crate) fn get(&self, name: &str) -> Option<&Tensor> {
        self.iter().find(|(candidate, _)| *candidate == name).map(|(_, tensor)| tensor)
    }

    /// A copy of all learned parameters in single precision.
    ///
    /// # Errors
    /// [`StarError::Torch`] when they cannot be fetched from their device.
    pub fn to_weights(&self) -> Result<Weights, StarError> {
        let here = self.flat.detach().f_to_device(Device::Cpu)?;
        let numbers = Vec::try_from(here.f_to_kind(Kind::Float)?)?;
        Ok(Weights::new(Arc::clone(&self.layout), numbers))
    }

    /// Copies learned parameters of the same layout.
    ///
    /// # Errors
    /// [`StarError::Network`] when they are of another layout; the parameters are then unchanged.
    pub fn set(&self, weights: &Weights) -> Result<(), StarError> {
        weights.check_layout(&self.layout)?;
        let _guard = tch::no_grad_guard();
        let numbers = Tensor::f_from_slice(weights.numbers())?;
        self.flat.shallow_clone().f_copy_(&numbers)?;
        Ok(())
    }

    /// The gradients of a loss with respect to the learned tensors, and to tensors of its computation; `None` for those
    /// that it does not depend on.
    pub(super) fn gradients_of(&self, loss: &Tensor, of: &[&Tensor]) -> Result<Gradients, tch::TchError> {
        let asked: Vec<&Tensor> = self.tensors.iter().chain(of.iter().copied()).collect();
        let found = Tensor::f_run_backward(&[loss], &asked, false, false)?;
        let mut learned: Vec<Option<Tensor>> =
            found.into_iter().map(|gradient| gradient.defined().then_some(gradient)).collect();
        let others = learned.split_off(self.tensors.len());
        Ok((learned, others))
    }
}
