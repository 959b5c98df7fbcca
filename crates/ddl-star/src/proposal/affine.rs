//! The affine map of every member of an ensemble at once.

use crate::parameters::Initializer;
use tch::Tensor;

/// An affine map of every member: y = x W + b.
#[derive(Debug)]
pub(super) struct Affine {
    weight: Tensor,
    bias: Tensor,
}

impl Affine {
    /// Uniform weights with the variance `gain`² · 2 / inputs (He et al. 2015), no bias.
    pub(super) fn new(
        init: &mut Initializer,
        name: &str,
        (members, inputs, outputs): (i64, i64, i64),
        gain: f64,
    ) -> Self {
        let bound = gain * (6.0 / inputs as f64).sqrt();
        let weight = init.uniform(format!("{name}.weight"), &[members, inputs, outputs], bound);
        let bias = init.constant(format!("{name}.bias"), &[members, 1, outputs], 0.0);
        Self { weight, bias }
    }

    /// # Shapes
    /// `x` `[M, B, inputs]` -> `[M, B, outputs]`.
    pub(super) fn forward(&self, x: &Tensor) -> Tensor {
        self.bias.baddbmm(x, &self.weight, 1.0, 1.0)
    }
}
