//! Temporal encoder: one layer in which a walker's newest token looks at its earlier ones.
//!
//! Only the newest token's output is used, and earlier tokens never change: so one query a step is
//! computed, and keys and values of the past are remembered. Same function, less work.

use crate::config::StarConfig;
use crate::encoder_layer::EncoderLayer;
use crate::parameters::Initializer;
use crate::pass::Pass;
use crate::remembered::KeyValue;
use crate::tokens::Tokens;

#[derive(Debug)]
pub(crate) struct TemporalEncoder {
    layer: EncoderLayer,
}

/// Keys and values of the tokens seen so far, oldest first.
#[derive(Debug, Default)]
pub(crate) struct TemporalMemory {
    tokens: Vec<KeyValue>,
}

impl TemporalMemory {
    pub(crate) fn push(&mut self, token: KeyValue) {
        self.tokens.push(token);
    }

    /// Repeats a single batch entry `batch` times, without copying.
    pub(crate) fn expand_batch(&self, batch: i64) -> Self {
        Self {
            tokens: self
                .tokens
                .iter()
                .map(|token| token.expand_batch(batch))
                .collect(),
        }
    }
}

impl TemporalEncoder {
    pub(crate) fn new(init: &mut Initializer, name: &str, config: &StarConfig) -> Self {
        Self {
            layer: EncoderLayer::new(init, &format!("{name}.layers.0"), config, 0.0),
        }
    }

    /// # Shapes
    /// `newest` `[B, P, width]` -> the same.
    pub(crate) fn forward(&self, newest: &Tokens, memory: &TemporalMemory, pass: &Pass) -> Tokens {
        self.layer.over_memory(newest, &memory.tokens, pass)
    }

    pub(crate) fn remember(&self, token: &Tokens, pass: &Pass) -> KeyValue {
        self.layer.remember(token, pass)
    }
}
