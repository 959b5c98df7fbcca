//! The two elementary layers: affine map and layer normalisation.

use std::rc::Rc;

use crate::kernel;
use crate::packed::Packed;
use crate::parameters::Initializer;
use crate::pass::Pass;
use crate::tokens::Tokens;
use tch::Tensor;

/// y = x W^T + b.
#[derive(Debug)]
pub(crate) struct Linear {
    pub(crate) weight: Tensor,
    pub(crate) bias: Tensor,
    packed: Packed<kernel::Linear>,
}

impl Linear {
    /// Weight and bias uniform in +-1/sqrt(inputs), the convention of the published code's library.
    pub(crate) fn new(init: &mut Initializer, name: &str, inputs: i64, outputs: i64) -> Self {
        let bound = 1.0 / (inputs as f64).sqrt();
        let start = init.count();
        Self {
            weight: init.uniform(format!("{name}.weight"), &[outputs, inputs], bound),
            bias: init.uniform(format!("{name}.bias"), &[outputs], bound),
            packed: Packed::new(init.since(start)),
        }
    }

    /// The same with a bias of zeros.
    pub(crate) fn with_zero_bias(
        init: &mut Initializer,
        name: &str,
        inputs: i64,
        outputs: i64,
    ) -> Self {
        let bound = 1.0 / (inputs as f64).sqrt();
        let start = init.count();
        Self {
            weight: init.uniform(format!("{name}.weight"), &[outputs, inputs], bound),
            bias: init.constant(format!("{name}.bias"), &[outputs], 0.0),
            packed: Packed::new(init.since(start)),
        }
    }

    /// Numbers in a row of x.
    pub(crate) fn inputs(&self) -> i64 {
        self.weight.size()[1]
    }

    /// # Shapes
    /// `x` `[.., inputs]` -> `[.., outputs]`.
    pub(crate) fn forward(&self, x: &Tensor, pass: &Pass) -> Tensor {
        pass.linear(x, &self.weight, &self.bias)
    }

    /// # Shapes
    /// `x` `[B, P, inputs]` -> `[B, P, outputs]`.
    pub(crate) fn of_tokens(&self, x: &Tokens, pass: &Pass) -> Tokens {
        let x = match x {
            Tokens::Tensor(x) => return Tokens::Tensor(self.forward(x, pass)),
            Tokens::Rows(x) => Rc::clone(x),
        };
        let [batch, walkers, inputs] = x.shape();
        let outputs = self.packed.span().len() / (inputs + 1);
        let kernel = self
            .packed
            .of(pass, || kernel::Linear::zeros(inputs, outputs));
        let (y, span) = (kernel.forward(&x), self.packed.span());
        Tokens::Rows(
            pass.made([batch, walkers, outputs], y, move |gy, of_weights| {
                x.add_gradient(kernel.backward(&x, gy, &mut of_weights[span]));
            }),
        )
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
