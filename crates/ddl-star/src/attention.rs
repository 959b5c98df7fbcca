//! Multi-head attention (Vaswani et al. 2017, section 3.2), in the two forms STAR needs:
//! every walker over its neighbours, and the newest token over all earlier ones.

use crate::layers::{Linear, Mode};
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
        let qkv = pass.linear(x, &self.in_proj_weight, &self.in_proj_bias);
        // Row by row: see `Packing`.
        let entries = qkv.size()[0];
        let rows = seen.in_rows(&qkv);
        let (count, length) = (rows.size()[0], rows.size()[1]);
        let parts = rows
            .view([count, length, 3, self.heads, self.width / self.heads])
            .unbind(2);
        let [query, key, value] = [0, 1, 2].map(|part: usize| parts[part].transpose(1, 2));
        let dropout = match pass.mode() {
            Mode::Train => self.dropout,
            Mode::Evaluate => 0.0,
        };
        let mixed = Tensor::scaled_dot_product_attention(
            &query,
            &key,
            &value,
            Some(&seen.row_mask(entries)),
            dropout,
            false,
            self.scale(),
            false,
        );
        let mixed = mixed.transpose(1, 2).reshape([count, length, self.width]);
        self.out_proj.forward(&seen.out_of_rows(&mixed), pass)
    }

    /// Attention of the newest token over itself and the remembered ones.
    ///
    /// # Shapes
    /// `newest` `[B, P, width]`; each memory as [`KeyValue`] -> `[B, P, width]`.
    pub(crate) fn over_memory(&self, newest: &Tensor, memory: &[KeyValue], pass: &Pass) -> Tensor {
        let (batch, walkers) = (newest.size()[0], newest.size()[1]);
        let qkv = pass.linear(newest, &self.in_proj_weight, &self.in_proj_bias);
        let mut tokens: Vec<&Tensor> = memory.iter().filter_map(KeyValue::projected).collect();
        tokens.push(&qkv);
        // All projections of all tokens at once: one copy, and one gradient for each token.
        let parts = Tensor::stack(&tokens, 0)
            .view([-1, batch, walkers, 3, self.heads, self.width / self.heads])
            .unbind(3);
        let (query, key, value) = (parts[0].narrow(0, -1, 1), &parts[1], &parts[2]);
        // One query a walker and head: products and sums beat a batch of 1 x t matrix products.
        let scores = (key * (query * self.scale())).sum_dim_intlist([-1i64].as_slice(), true, None);
        let weights = scores.softmax(0, scores.kind());
        let mixed = (value * weights)
            .sum_dim_intlist([0i64].as_slice(), false, None)
            .reshape([batch, walkers, self.width]);
        self.out_proj.forward(&mixed, pass)
    }

    /// Key and value of tokens, to be remembered.
    ///
    /// # Shapes
    /// `token` `[B, P, width]`.
    pub(crate) fn remember(&self, token: &Tensor, pass: &Pass) -> KeyValue {
        // The query is projected too and never used: a part of the weights would have a gradient as large
        // as the whole, at every token.
        KeyValue::Projected(pass.linear(token, &self.in_proj_weight, &self.in_proj_bias))
    }

    fn scale(&self) -> f64 {
        1.0 / ((self.width / self.heads) as f64).sqrt()
    }
}
