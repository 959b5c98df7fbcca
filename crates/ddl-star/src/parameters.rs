//! The learned tensors, by name and in order, and their seeded initial values.

use crate::kernel::Gradients;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use tch::{Device, Kind, Tensor};

/// The learned tensors of a network, in the order in which its layers were made.
///
/// All of them are views into one flat vector, so that the optimiser, gradient clipping and
/// checkpoints of its state work on a single tensor.
#[derive(Debug)]
pub struct Parameters {
    entries: Vec<(String, Tensor)>,
    flat: Tensor,
}

impl Parameters {
    /// Names and tensors, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Tensor)> {
        self.entries
            .iter()
            .map(|(name, tensor)| (name.as_str(), tensor))
    }

    /// The tensor of that name.
    pub fn get(&self, name: &str) -> Option<&Tensor> {
        self.iter()
            .find(|(candidate, _)| *candidate == name)
            .map(|(_, tensor)| tensor)
    }

    /// How many tensors there are.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// How many numbers are learned in all.
    pub fn count(&self) -> usize {
        self.flat.numel()
    }

    /// All learned numbers as one vector that shares its memory with the tensors.
    pub(crate) fn flat(&self) -> &Tensor {
        &self.flat
    }

    /// Forgets the gradients of an earlier pass.
    pub(crate) fn zero_gradients(&self) {
        for (_, tensor) in &self.entries {
            tensor.shallow_clone().zero_grad();
        }
    }

    /// The gradients that libtorch has added up, and those of kernels, as one vector like [`flat`](Self::flat).
    pub(crate) fn flat_gradient(
        &self,
        kernels: &BTreeMap<String, Gradients>,
    ) -> Result<Tensor, tch::TchError> {
        let rows = self
            .entries
            .iter()
            .map(|(name, tensor)| {
                let gradient = tensor.f_grad()?;
                let gradient = if gradient.defined() {
                    gradient.f_reshape([-1])?
                } else {
                    tensor.f_zeros_like()?.f_reshape([-1])?
                };
                match kernels
                    .iter()
                    .find_map(|(layer, of)| named(of, name.strip_prefix(layer)?))
                {
                    Some(kernel) => gradient.f_add(&Tensor::from_slice(kernel)),
                    None => Ok(gradient),
                }
            })
            .collect::<Result<Vec<_>, _>>()?;
        Tensor::f_cat(&rows, 0)
    }
}

/// The gradient of a weight of a feed-forward block, by its name within the layer.
fn named<'a>(gradients: &'a Gradients, name: &str) -> Option<&'a [f32]> {
    match name {
        ".linear1.weight" => Some(&gradients.w1),
        ".linear1.bias" => Some(&gradients.b1),
        ".linear2.weight" => Some(&gradients.w2),
        ".linear2.bias" => Some(&gradients.b2),
        _ => None,
    }
}

/// Makes the tensors of a network while its layers are built.
///
/// Values are drawn from a `ChaCha8` stream, so that the same seed gives the same network on every
/// machine and device.
#[derive(Debug)]
pub(crate) struct Initializer {
    rng: ChaCha8Rng,
    device: Device,
    kind: Kind,
    entries: Vec<(String, Tensor)>,
}

impl Initializer {
    pub(crate) fn new(rng: ChaCha8Rng, device: Device, kind: Kind) -> Self {
        Self {
            rng,
            device,
            kind,
            entries: Vec::new(),
        }
    }

    /// Moves all tensors made so far into one flat vector.
    pub(crate) fn finish(self) -> Parameters {
        let _guard = tch::no_grad_guard();
        let rows: Vec<Tensor> = self
            .entries
            .iter()
            .map(|(_, tensor)| tensor.detach().reshape([-1]))
            .collect();
        let flat = Tensor::cat(&rows, 0);
        let mut offset = 0;
        let mut entries = self.entries;
        for (_, tensor) in &mut entries {
            let count = tensor.numel() as i64;
            let view = flat.narrow(0, offset, count).view(tensor.size().as_slice());
            tensor.set_data(&view);
            offset += count;
        }
        Parameters { entries, flat }
    }

    /// Uniform in [-bound, bound].
    pub(crate) fn uniform(&mut self, name: String, shape: &[i64], bound: f64) -> Tensor {
        let count = shape.iter().product::<i64>() as usize;
        let values: Vec<f64> = (0..count)
            .map(|_| bound * (2.0 * self.rng.random::<f64>() - 1.0))
            .collect();
        self.register(name, &Tensor::from_slice(&values).reshape(shape))
    }

    /// Every entry equal to `value`.
    pub(crate) fn constant(&mut self, name: String, shape: &[i64], value: f64) -> Tensor {
        self.register(
            name,
            &Tensor::full(shape, value, (Kind::Double, Device::Cpu)),
        )
    }

    fn register(&mut self, name: String, values: &Tensor) -> Tensor {
        let tensor = values
            .to_kind(self.kind)
            .to_device(self.device)
            .set_requires_grad(true);
        self.entries.push((name, tensor.shallow_clone()));
        tensor
    }
}
