//! Backends that convert tokens from and to tensors, for the rollout of training.

use super::backend::TorchBackend;
use super::batch::SceneBatch;
use super::network::Layers;
use ddl_network::backend::{Backend, Buffer, KernelBackend, Rows, VisibleScenes};
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
#[derive(Debug, Clone, Copy)]
pub(crate) enum Pass<'a> {
    /// On any device, in any precision.
    Torch(&'a TorchBackend),
    /// Forwards and backwards.
    Kernels(&'a KernelBackend),
}

impl Layers {
    /// The gradient of `loss`, which a pass of `kernels` computed, with respect to all `count` learned numbers of the
    /// network. `output` are the weights of the output layer of this pass, leaves of libtorch's graph.
    ///
    /// # Errors
    /// Those of libtorch.
    pub(crate) fn gradient_by_kernels(
        &self,
        kernels: &KernelBackend,
        loss: &Tensor,
        output: &[Tensor; 2],
        count: usize,
    ) -> Result<Vec<f32>, TchError> {
        loss.f_backward()?;
        let mut sums = vec![0.0; count];
        kernels.backward(&mut sums);
        // libtorch computes the output layer.
        let mut rest = &mut sums[self.output.span()];
        for learned in output {
            let part = rest.split_off_mut(..learned.numel()).unwrap_or_default();
            let gradient = learned.f_grad()?;
            if gradient.defined() {
                part.copy_from_slice(&numbers(&gradient));
            }
        }
        Ok(sums)
    }
}

#[cfg(test)]
#[path = "pass_tests.rs"]
mod tests;
