//! One run through the network: whether dropout is on, who computes, and how gradients come back.

use std::cell::Cell;
use std::ops::Range;
use std::rc::Rc;

use tch::{Kind, TchError, Tensor};

use crate::kernel::{Buffer, Dropout};
use crate::layers::Mode;
use crate::numbers::numbers;
use crate::parameters::Parameters;
use crate::precision::Precision;
use crate::shared_weights::SharedWeights;
use crate::tape::Tape;
use crate::tokens::Rows;

/// What a forward pass carries along.
#[derive(Debug)]
pub(crate) struct Pass {
    mode: Mode,
    /// Seed of the next dropout.
    seed: Cell<u64>,
    /// For the kernels; `None` where libtorch computes all.
    weights: Option<Weights>,
    tape: Option<Tape>,
    /// For training by libtorch.
    shared: Option<SharedWeights>,
}

/// The learned numbers, as they are in a pass.
#[derive(Debug)]
pub(crate) struct Weights {
    flat: Tensor,
    /// See [`Parameters::version`].
    pub(crate) version: i64,
    /// Of the products in feed-forward blocks.
    pub(crate) precision: Precision,
}

impl Weights {
    pub(crate) fn numbers(&self, span: Range<usize>) -> Buffer {
        let (first, count) = (span.start as i64, span.len() as i64);
        numbers(&self.flat.narrow(0, first, count))
    }
}

impl Pass {
    /// A pass of libtorch alone, on any device, in any precision; gradients are its own.
    pub(crate) fn plain(mode: Mode) -> Self {
        Self {
            mode,
            seed: Cell::new(0),
            weights: None,
            tape: None,
            shared: None,
        }
    }

    /// A pass without gradients, by kernels of our own where they can: on the CPU, in `f32`.
    pub(crate) fn forward_only(mode: Mode, parameters: &Parameters, precision: Precision) -> Self {
        let flat = parameters.flat();
        let kernels = flat.kind() == Kind::Float && flat.device() == tch::Device::Cpu;
        Self {
            weights: kernels.then(|| Weights {
                flat: flat.shallow_clone(),
                version: parameters.version(),
                precision,
            }),
            ..Self::plain(mode)
        }
    }

    /// A pass of training, by kernels where they can, in `f32`: dropout by this seed, gradients by [`gradient`](Self::gradient).
    pub(crate) fn training(mode: Mode, seed: u64, parameters: &Parameters) -> Self {
        let pass = Self::forward_only(mode, parameters, Precision::F32);
        Self {
            seed: Cell::new(seed),
            tape: pass.weights.is_some().then(Tape::default),
            shared: pass.weights.is_none().then(SharedWeights::default),
            ..pass
        }
    }

    pub(crate) fn mode(&self) -> Mode {
        self.mode
    }

    /// Whether kernels of our own compute.
    pub(crate) fn has_kernels(&self) -> bool {
        self.weights.is_some()
    }

    /// # Panics
    /// When no kernels compute.
    pub(crate) fn weights(&self) -> &Weights {
        self.weights.as_ref().expect("a pass with kernels")
    }

    /// What a kernel has computed; `backward` gets the gradient of it, and adds to those of the kernel's inputs and
    /// of all learned numbers.
    pub(crate) fn made(
        &self,
        shape: [usize; 3],
        numbers: Buffer,
        backward: impl FnOnce(&[f32], &mut [f32]) + 'static,
    ) -> Rc<Rows> {
        let rows = Rc::new(Rows::new(shape, numbers));
        let output = Rc::clone(&rows);
        self.on_the_way_back(move |of_weights| {
            // Otherwise nothing of the loss depends on it.
            if let Some(gradient) = output.take_gradient() {
                backward(&gradient, of_weights);
            }
        });
        rows
    }

    /// Runs `step` when the gradients of all that comes later are known.
    pub(crate) fn on_the_way_back(&self, step: impl FnOnce(&mut [f32]) + 'static) {
        if let Some(tape) = &self.tape {
            tape.push(step);
        }
    }

    /// Whether gradients will be asked for.
    pub(crate) fn is_taped(&self) -> bool {
        self.tape.is_some()
    }

    /// y = x W^T + b, by libtorch. In training the gradients of W and b are left to [`gradient`](Self::gradient).
    ///
    /// # Shapes
    /// `x` `[.., inputs]`, `weight` `[outputs, inputs]`, `bias` `[outputs]` -> `[.., outputs]`.
    pub(crate) fn linear(&self, x: &Tensor, weight: &Tensor, bias: &Tensor) -> Tensor {
        match &self.shared {
            Some(shared) => shared.linear(x, weight, bias),
            None => x.linear(weight, Some(bias)),
        }
    }

    /// The dropout of a kernel with probability `p`, each with a seed of its own; none outside training.
    pub(crate) fn dropout(&self, p: f64) -> Option<Dropout> {
        if self.mode == Mode::Evaluate || p == 0.0 {
            return None;
        }
        let seed = self.seed.get();
        // An odd constant goes through all numbers before one comes back.
        self.seed.set(seed.wrapping_add(0x9e37_79b9_7f4a_7c15));
        Some(Dropout { p, seed })
    }

    /// The gradient of `loss` with respect to all learned numbers, as one vector.
    pub(crate) fn gradient(
        &self,
        loss: &Tensor,
        parameters: &Parameters,
    ) -> Result<Tensor, TchError> {
        if let Some(shared) = &self.shared {
            return shared.gradient(loss, parameters);
        }
        let Some(tape) = &self.tape else {
            return parameters.gradient_of(loss);
        };
        parameters.zero_gradients();
        loss.f_backward()?;
        let mut sums = vec![0.0; parameters.count()];
        tape.backward(&mut sums);
        parameters.add_gradients(&mut sums)?;
        Tensor::f_from_slice(&sums)
    }
}

#[cfg(test)]
mod tests;
