//! The three elementary layers: affine map, layer normalisation, feed-forward block.

use crate::parameters::Initializer;
use crate::pass::Pass;
use tch::Tensor;

/// y = x W^T + b.
#[derive(Debug)]
pub(crate) struct Linear {
    pub(crate) weight: Tensor,
    pub(crate) bias: Tensor,
}

impl Linear {
    /// Weight and bias uniform in +-1/sqrt(inputs), the convention of the published code's library.
    pub(crate) fn new(init: &mut Initializer, name: &str, inputs: i64, outputs: i64) -> Self {
        let bound = 1.0 / (inputs as f64).sqrt();
        Self {
            weight: init.uniform(format!("{name}.weight"), &[outputs, inputs], bound),
            bias: init.uniform(format!("{name}.bias"), &[outputs], bound),
        }
    }

    /// # Shapes
    /// `x` `[.., inputs]` -> `[.., outputs]`.
    pub(crate) fn forward(&self, x: &Tensor) -> Tensor {
        x.linear(&self.weight, Some(&self.bias))
    }

    /// The same as one of many uses in a pass.
    pub(crate) fn forward_in(&self, x: &Tensor, pass: &Pass) -> Tensor {
        pass.linear(x, &self.weight, &self.bias)
    }
}

/// Layer normalisation over the last dimension (Ba et al. 2016), eps = 1e-5.
#[derive(Debug)]
pub(crate) struct LayerNorm {
    weight: Tensor,
    bias: Tensor,
}

impl LayerNorm {
    pub(crate) fn new(init: &mut Initializer, name: &str, width: i64) -> Self {
        Self {
            weight: init.constant(format!("{name}.weight"), &[width], 1.0),
            bias: init.constant(format!("{name}.bias"), &[width], 0.0),
        }
    }

    /// # Shapes
    /// `x` `[.., width]` -> the same.
    pub(crate) fn forward(&self, x: &Tensor) -> Tensor {
        x.layer_norm(
            self.weight.size(),
            Some(&self.weight),
            Some(&self.bias),
            1e-5,
            true,
        )
    }
}

/// Whether dropout is active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Dropout on.
    Train,
    /// Dropout off: the forecast is a function of its inputs.
    Evaluate,
}
