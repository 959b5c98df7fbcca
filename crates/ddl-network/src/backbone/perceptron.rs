//! A small perceptron. Its features depend on the goal offset and the observed motion, not on other pedestrians.

use crate::StarConfig;
use crate::backbone::features::{Backbone, output_layer};
use crate::backend::{Backend, Memory};
use crate::config::NetworkFrame;
use crate::weights::{Layout, Linear};
use ddl_core::OBSERVED;

/// The backbone without a Transformer: two hidden layers on the present and observed positions of the pedestrian.
#[derive(Debug, Clone)]
pub struct Perceptron {
    frame: NetworkFrame,
    hidden: Linear,
    token: Linear,
    output: Linear,
}

impl Perceptron {
    /// Declares its hidden layers: one of width `feed_forward_width`, and one of width `model_width`.
    pub fn new(layout: &mut Layout, config: &StarConfig) -> Self {
        let inputs = config.temporal_inputs() as usize * (OBSERVED + 1);
        let [width, hidden] = [config.model_width, config.feed_forward_width].map(|n| n as usize);
        Self {
            frame: config.frame,
            hidden: layout.linear("hidden_layer", inputs, hidden),
            token: layout.linear("token_layer", hidden, width),
            output: output_layer(layout, config),
        }
    }
}

impl<B: Backend> Backbone<B> for Perceptron {
    fn output(&self) -> Linear {
        self.output
    }

    fn scene(&self, _: &B, centred: &B::Tokens, _: &B::Seen) -> B::Tokens {
        centred.clone()
    }

    fn step(&self, backend: &B, memory: &mut Memory<B>, relative: &B::Tokens, _: &B::Tokens, _: &B::Seen) -> B::Tokens {
        if memory.tokens.len() < OBSERVED {
            memory.tokens.push(relative.clone());
        }
        // During the observation, the present position replaces the observed positions that are still to come.
        let observed = (0..OBSERVED).map(|t| memory.tokens.get(t).unwrap_or(relative));
        let inputs = observed.fold(relative.clone(), |inputs, x| {
            let x = backend.repeated(x, backend.entries(relative));
            backend.concatenate(&inputs, &x)
        });
        let hidden = backend.relu(&backend.linear(self.hidden, &inputs));
        let token = backend.relu(&backend.linear(self.token, &hidden));
        match self.frame {
            NetworkFrame::World => token,
            NetworkFrame::Goal => backend.concatenate(&token, relative),
        }
    }
}
