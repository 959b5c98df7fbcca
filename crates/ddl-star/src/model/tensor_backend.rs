//! Backends that convert tokens from and to tensors, for the rollout of training.

use super::backend::TorchBackend;
use super::batch::SceneBatch;
use super::parameters::Parameters;
use ddl_network::backend::{Backend, Buffer, KernelBackend, Kernels, Mode, Rows, VisibleScenes};
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

/// One pass through a network: by libtorch, or by kernels where possible, on the CPU in `f32`.
#[derive(Debug)]
pub(crate) enum Pass {
    /// On any device, in any precision.
    Torch(TorchBackend),
    /// Forwards and backwards.
    Kernels(KernelBackend),
}

impl Pass {
    /// A training pass: dropout by this seed in the kernels, gradients by [`gradient`](Self::gradient).
    pub(crate) fn training(mode: Mode, seed: u64, parameters: &Parameters, kernels: Option<&Arc<Kernels>>) -> Self {
        match kernels {
            Some(kernels) => Self::Kernels(KernelBackend::training(Arc::clone(kernels), mode, seed)),
            None => Self::Torch(TorchBackend::training(parameters, mode)),
        }
    }

    /// The gradient of `loss` with respect to all learned parameters, as one vector.
    pub(crate) fn gradient(&self, loss: &Tensor, parameters: &Parameters) -> Result<Tensor, TchError> {
        let kernels = match self {
            Self::Torch(torch) => return torch.gradient(loss, parameters),
            Self::Kernels(kernels) => kernels,
        };
        for tensor in parameters.tensors() {
            tensor.shallow_clone().zero_grad();
        }
        loss.f_backward()?;
        let mut sums = vec![0.0; parameters.count()];
        kernels.backward(&mut sums);
        // The gradients of the layers that libtorch computes.
        let tensors = parameters.layout().tensors().iter();
        for (learned, tensor) in parameters.tensors().iter().zip(tensors) {
            let gradient = learned.f_grad()?;
            if gradient.defined() {
                let terms = numbers(&gradient);
                for (sum, term) in sums[tensor.span()].iter_mut().zip(terms.iter()) {
                    *sum += term;
                }
            }
        }
        Tensor::f_from_slice(&sums)
    }
}

#[cfg(test)]
#[path = "pass_tests.rs"]
mod tests;
