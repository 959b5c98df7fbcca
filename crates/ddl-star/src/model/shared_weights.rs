//! Affine maps that are applied many times in a pass, with the gradients of their weights from all uses at once. The
//! gradient of the output of every use is kept, and dW = G^T X is one product over the rows of all uses. On CUDA, the
//! time of separate gradients at each of 19 frames would mostly be kernel launches.

use std::cell::RefCell;
use std::collections::BTreeMap;

use tch::{Kind, TchError, Tensor};

use crate::model::parameters::Parameters;

/// One use: y = x W^T + b.
#[derive(Debug)]
struct Use {
    weight: Tensor,
    bias: Tensor,
    input: Tensor,
    output: Tensor,
}

#[derive(Debug, Default)]
pub(crate) struct SharedWeights {
    uses: RefCell<Vec<Use>>,
}

/// Inputs and gradients of outputs, in row-major order, of all uses of a weight and its bias.
#[derive(Debug)]
struct UsedRows {
    bias: usize,
    inputs: Vec<Tensor>,
    gradients: Vec<Tensor>,
}

impl SharedWeights {
    /// y = x W^T + b, which only [`gradient`](Self::gradient) differentiates.
    /// Shapes: `x` `[.., inputs]`, `weight` `[outputs, inputs]`, `bias` `[outputs]` -> `[.., outputs]`.
    pub(crate) fn linear(&self, x: &Tensor, weight: &Tensor, bias: &Tensor) -> Tensor {
        let output = x.linear(&weight.detach(), Some(&bias.detach()));
        let output = if output.requires_grad() {
            output
        } else {
            output.set_requires_grad(true)
        };
        self.uses.borrow_mut().push(Use {
            weight: weight.shallow_clone(),
            bias: bias.shallow_clone(),
            input: x.detach(),
            output: output.shallow_clone(),
        });
        output
    }

    /// The gradient of `loss` with respect to all learned parameters, as one vector; clears the uses.
    pub(crate) fn gradient(&self, loss: &Tensor, parameters: &Parameters) -> Result<Tensor, TchError> {
        let uses = self.uses.take();
        let tensors: Vec<&Tensor> = parameters.tensors().iter().collect();
        let outputs = uses.iter().map(|applied| &applied.output);
        let asked: Vec<&Tensor> = tensors.iter().copied().chain(outputs).collect();
        let mut gradients = Tensor::f_run_backward(&[loss], &asked, false, false)?;
        let of_outputs = gradients.split_off(tensors.len());
        let mut shares = shares(&uses, of_outputs)?;
        let rows = gradients
            .into_iter()
            .zip(tensors)
            .map(|(direct, tensor)| {
                let whole = match (direct.defined(), shares.remove(&place(tensor))) {
                    (true, Some(share)) => direct.f_add(&share)?,
                    (true, None) => direct,
                    (false, Some(share)) => share,
                    (false, None) => tensor.f_zeros_like()?,
                };
                whole.f_reshape([-1])
            })
            .collect::<Result<Vec<_>, TchError>>()?;
        Tensor::f_cat(&rows, 0)
    }
}

/// The gradients of weights and biases, by their address, from those of the uses' outputs.
fn shares(uses: &[Use], of_outputs: Vec<Tensor>) -> Result<BTreeMap<usize, Tensor>, TchError> {
    let mut by_weight: BTreeMap<usize, UsedRows> = BTreeMap::new();
    for (applied, gradient) in uses.iter().zip(of_outputs) {
        // The loss may not depend on a use. For example, the memory of the last frame is never read.
        if !gradient.defined() {
            continue;
        }
        let (outputs, inputs) = applied.weight.size2()?;
        let rows = by_weight.entry(place(&applied.weight)).or_insert_with(|| UsedRows {
            bias: place(&applied.bias),
            inputs: Vec::new(),
            gradients: Vec::new(),
        });
        rows.inputs.push(applied.input.f_reshape([-1, inputs])?);
        rows.gradients.push(gradient.f_reshape([-1, outputs])?);
    }
    let mut shares = BTreeMap::new();
    for (weight, rows) in by_weight {
        let gradients = Tensor::f_cat(&rows.gradients, 0)?;
        let inputs = Tensor::f_cat(&rows.inputs, 0)?;
        let product = gradients.f_transpose(0, 1)?.f_matmul(&inputs)?;
        shares.insert(weight, product);
        let sum = gradients.f_sum_dim_intlist([0i64].as_slice(), false, None::<Kind>)?;
        shares.insert(rows.bias, sum);
    }
    Ok(shares)
}

/// The address of its numbers identifies a learned tensor: no tensor is empty, and no two overlap.
fn place(tensor: &Tensor) -> usize {
    tensor.data_ptr() as usize
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;
    use ddl_network::seed::{Stage, stream};
    use ddl_network::weights::Layout;
    use proptest::prelude::*;
    use tch::Device;

    proptest! {
        #[test]
        fn gradients_are_those_of_libtorch(uses in 1_usize..6, pedestrians in 1_i64..5, seed in 0_u64..99) {
            let rng = stream(seed, Stage::Weights, 0);
            let mut layout = Layout::default();
            let mut uniform = |name: &str, shape: &[usize]| layout.uniform(name.to_owned(), shape, 1.0);
            let first = [uniform("first.weight", &[3, 3]), uniform("first.bias", &[3])];
            let second = [uniform("second.weight", &[2, 3]), uniform("second.bias", &[2])];
            let _unused = uniform("unused", &[4]);
            let initial = layout.initial(rng);
            let parameters = Parameters::new(layout, &initial, Device::Cpu, Kind::Double);
            let learned = |tensors: [usize; 2]| tensors.map(|tensor| parameters.tensors()[tensor].shallow_clone());
            let (first, second) = (learned(first), learned(second));
            tch::manual_seed(seed as i64);
            let start = Tensor::randn([2, pedestrians, 3], (Kind::Double, Device::Cpu));
            let loss = |linear: &dyn Fn(&Tensor, &[Tensor; 2]) -> Tensor| {
                let mut x = start.shallow_clone();
                let mut sum = first[0].square().sum(Kind::Double);
                for _ in 0..uses {
                    x = linear(&x, &first).tanh();
                    sum += linear(&x, &second).square().sum(Kind::Double);
                    let _nobody = linear(&x, &second);
                }
                sum
            };
            let shared = SharedWeights::default();
            let ours = loss(&|x, [weight, bias]| shared.linear(x, weight, bias));
            let ours = shared.gradient(&ours, &parameters).unwrap();
            let expected = loss(&|x, [weight, bias]| x.linear(weight, Some(bias)));
            let expected = parameters.gradient_of(&expected).unwrap();
            let size = expected.abs().max().double_value(&[]).max(1.0);
            let difference = (ours - expected).abs().max().double_value(&[]);
            prop_assert!(difference < 1e-12 * size, "{} of {}", difference, size);
        }
    }
}
