//! Multi-head attention (Vaswani et al. 2017, section 3.2), in the two forms STAR needs:
//! every walker over its neighbours, and the newest token over all earlier ones.

use crate::kernel::{AmongWalkers, Attended};
use crate::layers::{Linear, Mode};
use crate::neighbours::Seen;
use crate::numbers::{numbers, tensor};
use crate::parameters::Initializer;
use crate::pass::Pass;
use crate::remembered::{self, KeyValue};
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
        let out_bound = 1.0 / (width as f64).sqrt();
        let out_proj = Linear {
            weight: init.uniform(
                format!("{name}.out_proj.weight"),
                &[width, width],
                out_bound,
            ),
            bias: init.constant(format!("{name}.out_proj.bias"), &[width], 0.0),
        };
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
        let mixed = if pass.kernels_may_take(&qkv) {
            self.among_walkers_by_kernel(&qkv, seen, pass)
        } else {
            self.among_walkers_by_libtorch(&qkv, seen, pass)
        };
        self.out_proj.forward_in(&mixed, pass)
    }

    /// The same between the projections by libtorch, row by row: see [`Packing`](crate::packing::Packing).
    ///
    /// # Shapes
    /// `qkv` `[B, P, 3 * width]` -> `[B, P, width]`.
    fn among_walkers_by_libtorch(&self, qkv: &Tensor, seen: &Seen, pass: &Pass) -> Tensor {
        let entries = qkv.size()[0];
        let rows = seen.in_rows(qkv);
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
        seen.out_of_rows(&mixed)
    }

    /// The same between the projections by [`AmongWalkers`], scene by scene.
    ///
    /// # Shapes
    /// `qkv` `[B, P, 3 * width]` -> `[B, P, width]`.
    fn among_walkers_by_kernel(&self, qkv: &Tensor, seen: &Seen, pass: &Pass) -> Tensor {
        let (shape, heads) = (qkv.size(), self.heads as usize);
        let kernel = AmongWalkers::new(heads, self.width as usize / heads);
        let dropout = pass.dropout(self.dropout);
        let (input, seen) = (numbers(qkv), seen.clone());
        let mut attended = Attended::default();
        kernel.forward(&input, seen.frames(), dropout, &mut attended);
        let output = tensor(attended.mixed(), &[shape[0], shape[1], self.width]);
        pass.made_of(&[qkv], output, move |gradient| {
            let mut of_input = vec![0.0; input.len()];
            let gradient = numbers(gradient);
            kernel.backward(
                &input,
                seen.frames(),
                dropout,
                &attended,
                &gradient,
                &mut of_input,
            );
            Ok(vec![tensor(&of_input, &shape)])
        })
    }

    /// Attention of the newest token over itself and the remembered ones.
    ///
    /// # Shapes
    /// `newest` `[B, P, width]`; each memory as [`KeyValue`] -> `[B, P, width]`.
    pub(crate) fn over_memory(&self, newest: &Tensor, memory: &[KeyValue], pass: &Pass) -> Tensor {
        let (batch, walkers) = (newest.size()[0], newest.size()[1]);
        let qkv = pass.linear(newest, &self.in_proj_weight, &self.in_proj_bias);
        let plain: Option<Vec<_>> = memory.iter().map(KeyValue::plain).collect();
        if let Some(plain) = plain.filter(|_| pass.kernels_may_take(&qkv)) {
            let mixed = remembered::over_memory(&qkv, plain, self.heads, pass);
            return self.out_proj.forward_in(&mixed, pass);
        }
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
        self.out_proj.forward_in(&mixed, pass)
    }

    /// Key and value of tokens, to be remembered.
    ///
    /// # Shapes
    /// `token` `[B, P, width]`.
    pub(crate) fn remember(&self, token: &Tensor, pass: &Pass) -> KeyValue {
        if !pass.kernels_may_take(token) {
            // The query is projected too and never used: a part of the weights would have a gradient as large
            // as the whole, at every token.
            return KeyValue::Projected(pass.linear(
                token,
                &self.in_proj_weight,
                &self.in_proj_bias,
            ));
        }
        let rows = 2 * self.width;
        let key_value = token.linear(
            &self.in_proj_weight.narrow(0, self.width, rows),
            Some(&self.in_proj_bias.narrow(0, self.width, rows)),
        );
        KeyValue::of(&key_value, pass)
    }

    fn scale(&self) -> f64 {
        1.0 / ((self.width / self.heads) as f64).sqrt()
    }
}

#[cfg(test)]
#[path = "attention_tests.rs"]
mod tests;
