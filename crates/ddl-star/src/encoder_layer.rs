//! One Transformer encoder layer: attention, then a feed-forward block, each with a residual
//! connection and normalised afterwards (post-norm, `ReLU`).

use crate::attention::{KeyValue, MultiHeadAttention};
use crate::config::StarConfig;
use crate::dropout::dropout;
use crate::layers::{LayerNorm, Linear, Mode};
use crate::parameters::Initializer;
use tch::Tensor;

#[derive(Debug)]
pub(crate) struct EncoderLayer {
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
            attention: MultiHeadAttention::new(init, &attention, width, config.heads, dropout),
            linear1: Linear::new(init, &format!("{name}.linear1"), width, hidden),
            linear2: Linear::new(init, &format!("{name}.linear2"), hidden, width),
            norm1: LayerNorm::new(init, &format!("{name}.norm1"), width),
            norm2: LayerNorm::new(init, &format!("{name}.norm2"), width),
            dropout,
        }
    }

    /// Every walker looks at its neighbours. Shapes as in [`MultiHeadAttention::among_walkers`].
    pub(crate) fn among_walkers(&self, x: &Tensor, mask: &Tensor, mode: Mode) -> Tensor {
        let attended = self.attention.among_walkers(x, mask, mode);
        self.after_attention(x, attended, mode)
    }

    /// The newest token looks at the remembered ones and itself.
    /// Shapes as in [`MultiHeadAttention::over_memory`].
    pub(crate) fn over_memory(&self, newest: &Tensor, memory: &[KeyValue], mode: Mode) -> Tensor {
        let attended = self.attention.over_memory(newest, memory);
        self.after_attention(newest, attended, mode)
    }

    pub(crate) fn remember(&self, token: &Tensor) -> KeyValue {
        self.attention.remember(token)
    }

    fn after_attention(&self, x: &Tensor, attended: Tensor, mode: Mode) -> Tensor {
        let x = self
            .norm1
            .forward(&(x + dropout(attended, self.dropout, mode)));
        let hidden = dropout(self.linear1.forward(&x).relu(), self.dropout, mode);
        let fed = dropout(self.linear2.forward(&hidden), self.dropout, mode);
        self.norm2.forward(&(x + fed))
    }
}
