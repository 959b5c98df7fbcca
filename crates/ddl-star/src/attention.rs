//! Multi-head attention (Vaswani et al. 2017, section 3.2), in the two forms STAR needs:
//! every walker over its neighbours, and the newest token over all earlier ones.

use crate::dropout::dropout;
use crate::layers::Linear;
use crate::neighbours::Seen;
use crate::parameters::Initializer;
use crate::pass::Pass;
use crate::remembered::KeyValue;
use tch::Tensor;

/// Multi-head attention with one joint projection for query, key and value.
#[derive(Debug)]
pub(crate) struct MultiHeadAttention {
    in_proj_weight: Tensor,
    in_proj_bias: Tensor,
    out_proj: Linear,
    heads: i64,
    width: i64,
    dropout: f64,
}

impl MultiHeadAttention {
    /// Xavier-uniform joint projection, zero biases.
    pub(crate) fn new(
        init: &mut Initializer,
        name: &str,
        width: i64,
        heads: i64,
        dropout: f64,
    ) -> Self {
        let bound = (6.0 / (4 * width) as f64).sqrt();
        let in_proj_weight =
            init.uniform(format!("{name}.in_proj_weight"), &[3 * width, width], bound);
        let in_proj_bias = init.constant(format!("{name}.in_proj_bias"), &[3 * width], 0.0);
        let out_proj = Linear::with_zero_bias(init, &format!("{name}.out_proj"), width, width);
        Self {
            in_proj_weight,
            in_proj_bias,
            out_proj,
            heads,
            width,
            dropout,
        }
    }

    /// Attention of every walker over the walkers that it sees.
    ///
    /// # Shapes
    /// `x` `[B, P, width]`; `seen` during one frame or B -> `[B, P, width]`.
    pub(crate) fn among_walkers(&self, x: &Tensor, seen: &Seen, pass: &Pass) -> Tensor {
        let (batch, walkers) = (x.size()[0], x.size()[1]);
        let qkv = x.linear(&self.in_proj_weight, Some(&self.in_proj_bias));
        let qkv = qkv
            .view([batch, walkers, 3, self.heads, self.width / self.heads])
            .permute([2, 0, 3, 1, 4]);
        let (query, key, value) = (qkv.get(0), qkv.get(1), qkv.get(2));
        let scores = (query * self.scale()).matmul(&key.transpose(-1, -2)) + seen.mask();
        let weights = scores.softmax(-1, scores.kind());
        let mixed = dropout(weights, self.dropout, pass.mode())
            .matmul(&value)
            .transpose(1, 2)
            .reshape([batch, walkers, self.width]);
        self.out_proj.forward(&mixed)
    }

    /// Attention of the newest token over itself and the remembered ones.
    ///
    /// # Shapes
    /// `newest` `[B, P, width]`; each memory as [`KeyValue`] -> `[B, P, width]`.
    pub(crate) fn over_memory(&self, newest: &Tensor, memory: &[KeyValue]) -> Tensor {
        let (batch, walkers) = (newest.size()[0], newest.size()[1]);
        let qkv = newest.linear(&self.in_proj_weight, Some(&self.in_proj_bias));
        let qkv = qkv.view([batch, walkers, 3, self.heads, self.width / self.heads]);
        let (query, key, value) = (qkv.select(2, 0), qkv.select(2, 1), qkv.select(2, 2));
        let mut keys = vec![&key];
        let mut values = vec![&value];
        for token in memory {
            if let KeyValue::Tensors { key, value } = token {
                keys.push(key);
                values.push(value);
            }
        }
        // One query a walker and head: products and sums beat a batch of 1 x t matrix products.
        let scores = (Tensor::stack(&keys, 0) * (query * self.scale())).sum_dim_intlist(
            [-1i64].as_slice(),
            true,
            None,
        );
        let weights = scores.softmax(0, scores.kind());
        let mixed = (Tensor::stack(&values, 0) * weights)
            .sum_dim_intlist([0i64].as_slice(), false, None)
            .reshape([batch, walkers, self.width]);
        self.out_proj.forward(&mixed)
    }

    /// Key and value of tokens, to be remembered.
    ///
    /// # Shapes
    /// `token` `[B, P, width]`.
    pub(crate) fn remember(&self, token: &Tensor) -> KeyValue {
        let (batch, walkers) = (token.size()[0], token.size()[1]);
        let rows = 2 * self.width;
        let key_value = token.linear(
            &self.in_proj_weight.narrow(0, self.width, rows),
            Some(&self.in_proj_bias.narrow(0, self.width, rows)),
        );
        let split = key_value.view([batch, walkers, 2, self.heads, self.width / self.heads]);
        KeyValue::Tensors {
            key: split.select(2, 0),
            value: split.select(2, 1),
        }
    }

    fn scale(&self) -> f64 {
        1.0 / ((self.width / self.heads) as f64).sqrt()
    }
}
