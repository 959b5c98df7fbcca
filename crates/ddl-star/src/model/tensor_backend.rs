//! Backends that convert tokens from and to tensors, and passes of training with their gradients.

use super::backend::TorchBackend;
use super::batch::SceneBatch;
use super::network::Layers;
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

    /// All batch entries of all tokens as a tensor of libtorch.
    fn joined(&self, all: &[Self::Tokens]) -> Tensor;

    /// The neighbours at the time steps `steps`: a single step applies to every batch entry, several steps to one entry
    /// each.
    fn seen(&self, batch: &SceneBatch, steps: Range<usize>) -> Self::Seen;
}

impl TensorBackend for TorchBackend {
    fn given(&self, x: &Tensor) -> Rc<Tensor> {
        Rc::new(x.shallow_clone())
    }

    fn each_entry(&self, x: &Rc<Tensor>) -> Vec<Rc<Tensor>> {
        // Split all at once: the gradient of each single slice would be padded to the whole and added.
        x.split(1, 0).into_iter().map(Rc::new).collect()
    }

    fn joined(&self, all: &[Rc<Tensor>]) -> Tensor {
        match all {
            [one] => one.shallow_clone(),
            all => Tensor::cat(&all.iter().map(|x| &**x).collect::<Vec<_>>(), 0),
        }
    }

    fn seen(&self, batch: &SceneBatch, steps: Range<usize>) -> Self::Seen {
        batch.neighbours.during(steps)
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

    fn joined(&self, all: &[Rc<Rows>]) -> Tensor {
        let tensor = |rows: &Rc<Rows>| {
            let shape = rows.shape().map(|count| count as i64);
            Tensor::from_slice(rows).reshape(shape)
        };
        let joined = match all {
            [one] => tensor(one),
            all => Tensor::cat(&all.iter().map(tensor).collect::<Vec<_>>(), 0),
        };
        // libtorch's graph begins at this leaf. In the backward pass, its gradient is added to the rows first.
        let leaf = joined.set_requires_grad(true);
        let joined = leaf.shallow_clone();
        let all = all.to_vec();
        self.record_backward(move |_| {
            let gradient = leaf.grad();
            if !gradient.defined() {
                return;
            }
            let gradient = numbers(&gradient);
            let mut rest = &gradient[..];
            for rows in &all {
                let part = rest.split_off(..rows.len()).unwrap_or_default();
                rows.add_gradient(Buffer::copy(part));
            }
        });
        joined
    }

    fn seen(&self, batch: &SceneBatch, steps: Range<usize>) -> VisibleScenes {
        VisibleScenes {
            scenes: Arc::clone(batch.neighbours.scenes()),
            steps,
        }
    }
}

/// The numbers of a tensor in row-major order.
pub(super) fn numbers(tensor: &Tensor) -> Buffer {
    let mut numbers = Buffer::any(tensor.numel());
    let plain = tensor.detach().contiguous();
    plain.copy_data(&mut numbers, tensor.numel());
    numbers
}

/// What computes one pass through a network.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Pass<'a> {
    /// libtorch, on any device and in any precision.
    Torch(&'a TorchBackend),
    /// Kernels, on the CPU in `f32`.
    Kernels(&'a KernelPass),
}

impl Pass<'_> {
    /// Weight and bias of the output layer, which libtorch computes in both cases.
    pub(super) fn output(&self, layer: Linear) -> [&Tensor; 2] {
        match self {
            Self::Torch(backend) => backend.learned(layer.tensor),
            Self::Kernels(pass) => pass.output.each_ref(),
        }
    }
}

/// A training pass by kernels, which can run beside others on other threads.
#[derive(Debug)]
pub(crate) struct KernelPass {
    pub(super) backend: KernelBackend,
    /// Copies of the weights of the output layer, with gradients of their own.
    output: [Tensor; 2],
}

impl KernelPass {
    /// A pass with dropout by this seed. `output` is of `TorchNetwork::copy_output`.
    pub(crate) fn new(kernels: &Arc<Kernels>, mode: Mode, seed: u64, output: [Tensor; 2]) -> Self {
        Self {
            backend: KernelBackend::training(Arc::clone(kernels), mode, seed),
            output,
        }
    }

    /// The gradient of `loss` with respect to all `count` learned numbers of the network.
    ///
    /// # Errors
    /// Those of libtorch.
    pub(crate) fn gradient(&self, loss: &Tensor, layers: &Layers, count: usize) -> Result<Vec<f32>, TchError> {
        loss.f_backward()?;
        let mut sums = vec![0.0; count];
        self.backend.backward(&mut sums);
        let mut rest = &mut sums[layers.output.span()];
        for learned in &self.output {
            let (of_learned, after) = rest.split_at_mut(learned.numel());
            let gradient = learned.f_grad()?;
            if gradient.defined() {
                of_learned.copy_from_slice(&numbers(&gradient));
            }
            rest = after;
        }
        Ok(sums)
    }
}

#[cfg(test)]
#[path = "pass_tests.rs"]
mod tests;
