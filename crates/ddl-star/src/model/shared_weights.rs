//! Weights that a training pass uses many times, with their gradients from all uses at once.
//!
//! Automatic gradients would compute the gradient of a weight at each of 19 time steps and add them up: on a graphics
//! card most of the time of a step would be launches of such small kernels. Here the gradients of the outputs of all
//! uses are kept, and dW = G^T X is one product over the rows of all of them.

use crate::model::parameters::Parameters;
use std::cell::RefCell;
use std::collections::BTreeMap;
use tch::{Kind, TchError, Tensor};

/// Added to the variance of a normalised row.
const EPSILON: f64 = 1e-5;
/// With more numbers than this, [`norm_of_many`] is used on a card.
const MANY: usize = 1 << 20;

/// A map of rows with a learned weight and, at the next index, a learned bias.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LearnedMap {
    /// y = x W^T + b.
    Affine,
    /// y = n(x) w + b, where n normalises a row to mean 0 and variance 1 (Ba et al. 2016).
    Norm,
}

#[derive(Debug)]
struct Use {
    map: LearnedMap,
    weight: usize,
    input: Tensor,
    output: Tensor,
}

/// Inputs and gradients of outputs, `[rows, width]` each, of all uses of a weight.
#[derive(Debug)]
struct UsedRows {
    map: LearnedMap,
    inputs: Vec<Tensor>,
    gradients: Vec<Tensor>,
}

/// The uses of weights in a pass.
#[derive(Debug, Default)]
pub(super) struct SharedWeights(RefCell<Vec<Use>>);

impl LearnedMap {
    /// Shapes: `x` `[.., inputs]` -> `[.., outputs]`.
    pub(super) fn apply(self, x: &Tensor, weight: &Tensor, bias: &Tensor) -> Tensor {
        match self {
            Self::Affine => x.linear(weight, Some(bias)),
            Self::Norm if x.device().is_cuda() && !x.requires_grad() && x.numel() > MANY => {
                norm_of_many(x, weight, bias)
            }
            Self::Norm => x.layer_norm(weight.size(), Some(weight), Some(bias), EPSILON, true),
        }
    }

    /// The gradients of weight and bias. Shapes: `inputs` `[R, inputs]`, `gradients` `[R, outputs]`.
    fn gradients(self, inputs: &Tensor, gradients: &Tensor) -> Result<[Tensor; 2], TchError> {
        let sum = |x: &Tensor| x.f_sum_dim_intlist([0i64].as_slice(), false, None::<Kind>);
        let of_weight = match self {
            Self::Affine => gradients.f_transpose(0, 1)?.f_matmul(inputs)?,
            Self::Norm => {
                let normal =
                    inputs.f_layer_norm(&inputs.size()[1..], None::<&Tensor>, None::<&Tensor>, EPSILON, true)?;
                sum(&(normal * gradients))?
            }
        };
        Ok([of_weight, sum(gradients)?])
    }
}

/// Layer normalisation of many narrow rows. libtorch's own kernel starts a block of threads for each: with 10,000
/// pedestrians x 20 a forecast takes 8 % longer with it.
fn norm_of_many(x: &Tensor, weight: &Tensor, bias: &Tensor) -> Tensor {
    let (variance, mean) = x.var_mean_dim([-1i64].as_slice(), false, true);
    let normal = (x - mean) * (variance + EPSILON).rsqrt();
    bias.addcmul(&normal, weight)
}

impl SharedWeights {
    /// The map of `x`, of which only [`gradient`](Self::gradient) gives the gradients of the weights.
    pub(super) fn used(&self, map: LearnedMap, x: &Tensor, tensors: &[Tensor], weight: usize) -> Tensor {
        let [of_weight, bias] = [weight, weight + 1].map(|index| tensors[index].detach());
        let output = map.apply(x, &of_weight, &bias);
        let output = if output.requires_grad() { output } else { output.set_requires_grad(true) };
        self.0.borrow_mut().push(Use { map, weight, input: x.detach(), output: output.shallow_clone() });
        output
    }

    /// The gradient of `loss` with respect to all learned numbers, as one vector like [`Parameters::flat`].
    pub(super) fn gradient(&self, loss: &Tensor, parameters: &Parameters) -> Result<Tensor, TchError> {
        let uses = self.0.take();
        let outputs: Vec<&Tensor> = uses.iter().map(|of| &of.output).collect();
        let (direct, of_outputs) = parameters.gradients_of(loss, &outputs)?;
        let mut shares = shares(&uses, of_outputs)?;
        let tensors = parameters.tensors.iter().enumerate().zip(direct);
        let gradients = tensors.map(|((index, tensor), direct)| match (direct, shares.remove(&index)) {
            (Some(direct), Some(share)) => direct.f_add(&share)?.f_reshape([-1]),
            (Some(one), None) | (None, Some(one)) => one.f_reshape([-1]),
            (None, None) => tensor.f_zeros_like()?.f_reshape([-1]),
        });
        Tensor::f_cat(&gradients.collect::<Result<Vec<_>, _>>()?, 0)
    }
}

impl Parameters {
    /// The gradient of a loss computed by libtorch's operations only, as one vector like `flat`.
    pub(crate) fn gradient_of(&self, loss: &Tensor) -> Result<Tensor, TchError> {
        SharedWeights::default().gradient(loss, self)
    }
}

/// The gradients of weights and biases, by their index, from those of the uses' outputs.
fn shares(uses: &[Use], of_outputs: Vec<Option<Tensor>>) -> Result<BTreeMap<usize, Tensor>, TchError> {
    let mut by_weight: BTreeMap<usize, UsedRows> = BTreeMap::new();
    for (of, gradient) in uses.iter().zip(of_outputs) {
        // The loss may not depend on a use: the memory of the last frame is never read.
        let Some(gradient) = gradient else { continue };
        let rows = by_weight.entry(of.weight).or_insert_with(|| UsedRows {
            map: of.map,
            inputs: Vec::new(),
            gradients: Vec::new(),
        });
        let in_rows = |x: &Tensor| x.f_reshape([-1, x.size()[x.dim() - 1]]);
        rows.inputs.push(in_rows(&of.input)?);
        rows.gradients.push(in_rows(&gradient)?);
    }
    let mut shares = BTreeMap::new();
    for (weight, UsedRows { map, inputs, gradients }) in by_weight {
        let [inputs, gradients] = [Tensor::f_cat(&inputs, 0)?, Tensor::f_cat(&gradients, 0)?];
        let [of_weight, of_bias] = map.gradients(&inputs, &gradients)?;
        shares.insert(weight, of_weight);
        shares.insert(weight + 1, of_bias);
    }
    Ok(shares)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tch::Device;

    #[test]
    fn many_rows_are_normalised_like_few() {
        tch::manual_seed(1);
        let of = |shape: &[i64]| Tensor::randn(shape, (Kind::Double, Device::Cpu));
        let (x, weight, bias) = (of(&[3, 50, 32]) * 9.0 + 4.0, of(&[32]), of(&[32]));
        let apart = norm_of_many(&x, &weight, &bias) - LearnedMap::Norm.apply(&x, &weight, &bias);
        assert!(apart.abs().max().double_value(&[]) < 1e-12, "{apart}");
    }
}
