//! The learned tensors, by name and in order, and their seeded initial values.

use crate::StarError;
use crate::numbers::numbers;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use std::ops::Range;
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

    /// A copy of all learned numbers in single precision, in the order of [`iter`](Self::iter).
    ///
    /// # Errors
    /// [`StarError::Torch`] when they cannot be fetched from their device.
    ///
    /// # Examples
    /// ```
    /// use ddl_star::{ComputeDevice, DeviceChoice, StarConfig, StarNetwork, Variant};
    ///
    /// let device = ComputeDevice::open(DeviceChoice::Cpu)?;
    /// let network = StarNetwork::new(StarConfig::recommended(Variant::Full), 1, device)?;
    /// let weights = network.parameters().to_vec()?;
    /// assert_eq!(weights.len(), network.parameters().count());
    /// # Ok::<(), ddl_star::StarError>(())
    /// ```
    pub fn to_vec(&self) -> Result<Vec<f32>, StarError> {
        let here = self.flat.detach().f_to_device(Device::Cpu)?;
        Ok(Vec::try_from(here.f_to_kind(Kind::Float)?)?)
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

    /// The gradient of a loss that only libtorch's operations lead to, as one vector like [`flat`](Self::flat).
    ///
    /// Nothing is added up in the tensors: there is nothing to forget before, and nothing to add to.
    pub(crate) fn gradient_of(&self, loss: &Tensor) -> Result<Tensor, tch::TchError> {
        let tensors: Vec<&Tensor> = self.entries.iter().map(|(_, tensor)| tensor).collect();
        let rows = Tensor::f_run_backward(&[loss], &tensors, false, false)?
            .iter()
            .zip(tensors)
            .map(|(gradient, tensor)| {
                if gradient.defined() {
                    gradient.f_reshape([-1])
                } else {
                    tensor.f_zeros_like()?.f_reshape([-1])
                }
            })
            .collect::<Result<Vec<_>, _>>()?;
        Tensor::f_cat(&rows, 0)
    }

    /// Adds the gradients that libtorch has added up to `sums`, numbers in the order of [`flat`](Self::flat).
    pub(crate) fn add_gradients(&self, sums: &mut [f32]) -> Result<(), tch::TchError> {
        let mut rest = sums;
        for (_, tensor) in &self.entries {
            let sums = rest.split_off_mut(..tensor.numel()).unwrap_or_default();
            let gradient = tensor.f_grad()?;
            if gradient.defined() {
                for (sum, term) in sums.iter_mut().zip(numbers(&gradient).iter()) {
                    *sum += term;
                }
            }
        }
        Ok(())
    }

    /// Another number whenever a learned number may have changed.
    pub(crate) fn version(&self) -> i64 {
        // Tensors count their changes. Each has a count of its own, although they share their memory.
        let tensors = self.entries.iter().map(|(_, tensor)| tensor);
        tensors
            .chain([&self.flat])
            .map(Tensor::internal_version)
            .sum()
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

    /// How many numbers there are so far.
    pub(crate) fn count(&self) -> usize {
        self.entries.iter().map(|(_, tensor)| tensor.numel()).sum()
    }

    /// Where the numbers made from `start` on stand in [`Parameters::flat`].
    pub(crate) fn since(&self, start: usize) -> Range<usize> {
        start..self.count()
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
