//! Backends that convert tokens from and to tensors, and passes of training with their gradients.
//!
//! A network is computed by one of them alone, from its inputs to its outputs. libtorch computes what follows, the path
//! and its loss, and gives back the gradients of the outputs.

use crate::model::backend::TorchBackend;
use crate::model::batch::WindowBatch;
use crate::model::network::Layers;
use ddl_network::StarConfig;
use ddl_network::backend::{Backend, Buffer, KernelBackend, Kernels, Mode, Rows, VisibleScenes};
use ddl_network::weights::Linear;
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;
use tch::{TchError, Tensor};

pub(crate) trait TensorBackend: Backend {
    /// Inputs of the network without gradients, `[B, P, width]`.
    fn given(&self, x: &Tensor) -> Self::Tokens;

    /// The batch entries, each `[1, P, width]`.
    fn each_entry(&self, x: &Self::Tokens) -> Vec<Self::Tokens>;

    /// All batch entries of the outputs of a network as a tensor of libtorch.
    fn outputs(&self, entries: &[Self::Tokens]) -> Tensor;

    /// The neighbours at the time steps `steps`: a single step applies to every batch entry, several steps to one entry
    /// each.
    fn seen(&self, batch: &WindowBatch, steps: Range<usize>) -> Self::Seen;
}

impl TensorBackend for TorchBackend {
    fn given(&self, x: &Tensor) -> Rc<Tensor> {
        Rc::new(x.shallow_clone())
    }

    fn each_entry(&self, x: &Rc<Tensor>) -> Vec<Rc<Tensor>> {
        // Split all at once: the gradient of each single slice would be padded to the whole and added.
        x.split(1, 0).into_iter().map(Rc::new).collect()
    }

    fn outputs(&self, entries: &[Rc<Tensor>]) -> Tensor {
        match entries {
            [one] => one.shallow_clone(),
            several => Tensor::cat(&several.iter().map(|x| &**x).collect::<Vec<_>>(), 0),
        }
    }

    fn seen(&self, batch: &WindowBatch, steps: Range<usize>) -> Self::Seen {
        batch.seen(steps)
    }
}

impl TensorBackend for KernelBackend {
    fn given(&self, x: &Tensor) -> Rc<Rows> {
        let shape = [0, 1, 2].map(|dimension: usize| x.size()[dimension] as usize);
        Rc::new(Rows::new(shape, numbers(x)))
    }

    fn each_entry(&self, x: &Rc<Rows>) -> Vec<Rc<Rows>> {
        let entries = 0..self.entries(x);
        entries.map(|entry| self.entry(x, entry)).collect()
    }

    fn outputs(&self, entries: &[Rc<Rows>]) -> Tensor {
        let tensor = |rows: &Rc<Rows>| {
            let shape = rows.shape().map(|count| count as i64);
            Tensor::from_slice(rows).reshape(shape)
        };
        let outputs = match entries {
            [one] => tensor(one),
            several => Tensor::cat(&several.iter().map(tensor).collect::<Vec<_>>(), 0),
        };
        // libtorch's graph begins at this leaf: its backward pass ends before that of the kernels begins.
        let leaf = outputs.set_requires_grad(true);
        let outputs = leaf.shallow_clone();
        let entries = entries.to_vec();
        self.record_backward(move |_| {
            let gradient = leaf.grad();
            if !gradient.defined() {
                return;
            }
            let gradient = numbers(&gradient);
            let mut rest = &gradient[..];
            for rows in &entries {
                let part = rest.split_off(..rows.len()).unwrap_or_default();
                rows.add_gradient(Buffer::copy(part));
            }
        });
        outputs
    }

    fn seen(&self, batch: &WindowBatch, steps: Range<usize>) -> VisibleScenes {
        VisibleScenes { scenes: Arc::clone(&batch.scenes), steps }
    }
}

/// The numbers of a tensor in row-major order.
pub(super) fn numbers(tensor: &Tensor) -> Buffer {
    let mut numbers = Buffer::any(tensor.numel());
    tensor.detach().contiguous().copy_data(&mut numbers, tensor.numel());
    numbers
}

/// What computes one pass through a network.
#[derive(Debug, Clone, Copy)]
pub(crate) enum TensorEngine<'a> {
    /// libtorch, on any device and in any precision.
    Torch(&'a TorchBackend),
    /// Kernels, on the CPU in `f32`.
    Kernels(&'a KernelPass),
}

impl TensorEngine<'_> {
    /// The columns of the output layer's weight for the noise, `[outputs, noise]`: they shape the expected metric.
    pub(super) fn noise_weight(&self, layer: Linear, config: &StarConfig) -> Tensor {
        match self {
            Self::Torch(backend) => {
                let [weight, _] = backend.learned(layer.tensor);
                weight.narrow(1, config.output_inputs(), config.noise_width)
            }
            Self::Kernels(pass) => pass.noise_weight.shallow_clone(),
        }
    }
}

/// A training pass by kernels, which can run beside others on other threads.
#[derive(Debug)]
pub(crate) struct KernelPass {
    pub(super) backend: KernelBackend,
    /// A copy with a gradient of its own.
    noise_weight: Tensor,
}

impl KernelPass {
    /// A pass with dropout by this seed. `noise_weight` is of `TorchNetwork::copy_noise_weight`.
    pub(crate) fn new(kernels: &Arc<Kernels>, mode: Mode, seed: u64, noise_weight: Tensor) -> Self {
        Self { backend: KernelBackend::training(Arc::clone(kernels), mode, seed), noise_weight }
    }

    /// The gradient of `loss` with respect to all `count` learned numbers of the network.
    ///
    /// # Errors
    /// Those of libtorch.
    pub(crate) fn gradient(&self, loss: &Tensor, layers: &Layers, count: usize) -> Result<Vec<f32>, TchError> {
        loss.f_backward()?;
        let mut sums = vec![0.0; count];
        self.backend.backward(&mut sums);
        let gradient = self.noise_weight.f_grad()?;
        if gradient.defined() {
            let width = self.noise_weight.size()[1] as usize;
            let Linear { inputs, outputs, .. } = layers.output;
            let rows = sums[layers.output.span()].chunks_exact_mut(inputs).take(outputs);
            for (row, terms) in rows.zip(numbers(&gradient).chunks_exact(width)) {
                for (sum, term) in row[inputs - width..].iter_mut().zip(terms) {
                    *sum += term;
                }
            }
        }
        Ok(sums)
    }
}

#[cfg(test)]
mod tests;
