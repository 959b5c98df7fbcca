//! One Transformer encoder layer: attention, then a feed-forward block, each with a residual
//! connection and normalised afterwards (post-norm, `ReLU`).

use crate::attention::MultiHeadAttention;
use crate::config::StarConfig;
use crate::dropout::dropout;
use crate::kernel::{FeedForward, Gradients};
use crate::layers::{LayerNorm, Linear};
use crate::neighbours::Seen;
use crate::numbers::{numbers, tensor};
use crate::parameters::Initializer;
use crate::pass::Pass;
use crate::remembered::KeyValue;
use tch::Tensor;

#[derive(Debug)]
pub(crate) struct EncoderLayer {
    name: String,
    attention: MultiHeadAttention,
    linear1: Linear,
    linear2: Linear,
    norm1: LayerNorm,
    norm2: LayerNorm,
    dropout: f64,
}

impl EncoderLayer {
    pub(crate) fn new(
        init: &mut Initializer,
        name: &str,
        config: &StarConfig,
        dropout: f64,
    ) -> Self {
        let (width, hidden) = (config.model_width, config.feed_forward_width);
        let attention = format!("{name}.self_attn");
        Self {
            name: name.to_owned(),
            attention: MultiHeadAttention::new(init, &attention, width, config.heads, dropout),
            linear1: Linear::new(init, &format!("{name}.linear1"), width, hidden),
            linear2: Linear::new(init, &format!("{name}.linear2"), hidden, width),
            norm1: LayerNorm::new(init, &format!("{name}.norm1"), width),
            norm2: LayerNorm::new(init, &format!("{name}.norm2"), width),
            dropout,
        }
    }

    /// Every walker looks at its neighbours. Shapes as in [`MultiHeadAttention::among_walkers`].
    pub(crate) fn among_walkers(&self, x: &Tensor, seen: &Seen, pass: &Pass) -> Tensor {
        let x = pass.junction(x);
        let attended = self.attention.among_walkers(&x, seen, pass);
        self.after_attention(&x, attended, pass)
    }

    /// The newest token looks at the remembered ones and itself.
    /// Shapes as in [`MultiHeadAttention::over_memory`].
    pub(crate) fn over_memory(&self, newest: &Tensor, memory: &[KeyValue], pass: &Pass) -> Tensor {
        let newest = pass.junction(newest);
        let attended = self.attention.over_memory(&newest, memory, pass);
        self.after_attention(&newest, attended, pass)
    }

    pub(crate) fn remember(&self, token: &Tensor, pass: &Pass) -> KeyValue {
        self.attention.remember(token, pass)
    }

    fn after_attention(&self, x: &Tensor, attended: Tensor, pass: &Pass) -> Tensor {
        let attended = dropout(attended, self.dropout, pass.mode());
        let x = pass.junction(&self.norm1.forward(&(x + attended)));
        let fed = if pass.kernels_may_take(&x) {
            self.feed_forward_by_kernel(&x, pass)
        } else {
            let hidden = self.linear1.forward(&x).relu();
            let hidden = dropout(hidden, self.dropout, pass.mode());
            self.linear2.forward(&hidden)
        };
        let fed = dropout(fed, self.dropout, pass.mode());
        self.norm2.forward(&(x + fed))
    }

    /// The feed-forward block by [`FeedForward`], whose hidden numbers never leave the cache.
    fn feed_forward_by_kernel(&self, x: &Tensor, pass: &Pass) -> Tensor {
        let (hidden, width) = self.linear1.weight.size2().unwrap_or_default();
        let (hidden, width) = (hidden as usize, width as usize);
        let kernel = pass.packed(&self.name, || {
            FeedForward::pack(
                pass.precision(),
                &numbers(&self.linear1.weight),
                &numbers(&self.linear1.bias),
                &numbers(&self.linear2.weight),
                &numbers(&self.linear2.bias),
                width,
                hidden,
            )
        });
        let dropout = pass.dropout(self.dropout);
        let input = numbers(x);
        let mut output = vec![0.0; input.len()];
        kernel.forward(&input, dropout, &mut output);
        let shape = x.size();
        let (name, gradients) = (self.name.clone(), pass.weight_gradients());
        let output = tensor(&output, &shape);
        pass.made_of(&[x], output, move |gradient| {
            let mut of_input = vec![0.0; input.len()];
            let mut gradients = gradients.borrow_mut();
            let of_weights = gradients
                .entry(name)
                .or_insert_with(|| Gradients::zeros(width, hidden));
            kernel.backward(
                &input,
                &numbers(gradient),
                dropout,
                &mut of_input,
                of_weights,
            );
            Ok(vec![tensor(&of_input, &shape)])
        })
    }
}
