//! Gradients through functions that libtorch does not know.
//!
//! A kernel of our own ends libtorch's graph at its inputs and begins a new one at its output, which is a
//! leaf. The tape remembers these cuts. Backwards, libtorch first differentiates what follows the last cut;
//! then each cut, from the last to the first, turns the gradient of its output into those of its inputs, from
//! where libtorch goes on.

use std::cell::RefCell;

use tch::{Kind, TchError, Tensor};

/// Gradients of the inputs of a cut; `None` when nothing of the loss depends on what was made of them.
type Backward = Box<dyn FnOnce() -> Result<Option<Vec<Tensor>>, TchError>>;

struct Cut {
    inputs: Vec<Tensor>,
    backward: Backward,
}

/// The cuts of one forward pass, in the order in which they were made.
#[derive(Default)]
pub(crate) struct Tape {
    cuts: RefCell<Vec<Cut>>,
}

impl std::fmt::Debug for Tape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Tape of {} cuts", self.cuts.borrow().len())
    }
}

impl Tape {
    /// `output` as a function of `inputs` whose gradient is `backward`: one tensor an input, of its shape.
    pub(crate) fn cut(
        &self,
        inputs: &[&Tensor],
        output: &Tensor,
        backward: impl FnOnce(&Tensor) -> Result<Vec<Tensor>, TchError> + 'static,
    ) -> Tensor {
        let output = output.set_requires_grad(true);
        let leaf = output.shallow_clone();
        self.push(inputs, move || {
            let gradient = leaf.f_grad()?;
            if gradient.defined() {
                backward(&gradient).map(Some)
            } else {
                Ok(None)
            }
        });
        output
    }

    /// The end of libtorch's graph at `input`: what is made of it is no tensor. `gradient` gives what came back.
    pub(crate) fn end(&self, input: &Tensor, gradient: impl FnOnce() -> Option<Tensor> + 'static) {
        self.push(&[input], move || {
            Ok(gradient().map(|gradient| vec![gradient]))
        });
    }

    /// Whether the graph is whole: no cut was made.
    pub(crate) fn is_empty(&self) -> bool {
        self.cuts.borrow().is_empty()
    }

    fn push(
        &self,
        inputs: &[&Tensor],
        backward: impl FnOnce() -> Result<Option<Vec<Tensor>>, TchError> + 'static,
    ) {
        self.cuts.borrow_mut().push(Cut {
            inputs: inputs.iter().map(|input| input.shallow_clone()).collect(),
            backward: Box::new(backward),
        });
    }

    /// Adds the gradient of `loss` to every leaf that it depends on, through all cuts. The tape is empty then.
    pub(crate) fn backward(&self, loss: &Tensor) -> Result<(), TchError> {
        loss.f_backward()?;
        for cut in self.cuts.take().into_iter().rev() {
            let Some(gradients) = (cut.backward)()? else {
                continue;
            };
            let mut parts = Vec::new();
            for (input, gradient) in cut.inputs.iter().zip(gradients) {
                if input.requires_grad() {
                    parts.push((input * gradient).f_sum(None::<Kind>)?);
                }
            }
            if let Some(sum) = parts.into_iter().reduce(|sum, part| sum + part) {
                sum.f_backward()?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tch::Device;

    /// y = x^3 through a cut, between functions that libtorch knows, once and twice in a row.
    #[test]
    fn gradients_pass_through_cuts() {
        let x = Tensor::from_slice(&[0.5, -2.0, 3.0]).set_requires_grad(true);
        let tape = Tape::default();
        let cube = |x: &Tensor| {
            let value = x.detach();
            let copy = value.shallow_clone();
            tape.cut(&[x], &value.pow_tensor_scalar(3), move |g| {
                Ok(vec![copy.square() * 3.0 * g])
            })
        };
        let once = cube(&x.sin());
        let twice = cube(&(&once * 2.0 + &x));
        let loss = (twice + once.cos()).sum(Kind::Double);
        tape.backward(&loss).unwrap();
        let ours = x.grad();

        let plain = x.detach().set_requires_grad(true);
        let once = plain.sin().pow_tensor_scalar(3);
        let twice = (&once * 2.0 + &plain).pow_tensor_scalar(3);
        (twice + once.cos()).sum(Kind::Double).backward();
        let difference = (ours - plain.grad()).abs().max().double_value(&[]);
        assert!(difference < 1e-12, "{difference}");
    }

    #[test]
    fn what_the_loss_does_not_depend_on_gets_no_gradient() {
        let x = Tensor::ones([2], (Kind::Double, Device::Cpu)).set_requires_grad(true);
        let tape = Tape::default();
        let _unused = tape.cut(&[&x], &x.detach(), |_| panic!("never asked"));
        tape.backward(&(&x * 2.0).sum(Kind::Double)).unwrap();
        assert_eq!(Vec::<f64>::try_from(x.grad()).unwrap(), [2.0, 2.0]);
    }
}
