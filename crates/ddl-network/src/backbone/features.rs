//! From what pedestrians see to features, and from these and noise to what shapes a step.

use crate::StarConfig;
use crate::backend::{Backend, Memory};
use crate::config::NetworkFrame;
use crate::weights::{Initial, Layout, Linear};
use std::fmt::Debug;

/// How much smaller the first weights of an output layer are that begins near L = I.
const NEAR_NEUTRAL: f64 = 0.1;

/// A network that turns what pedestrians see, step by step, into features. To add one: the guide on extending.
pub trait Backbone<B: Backend>: Debug + Send + Sync {
    /// The output layer that it has declared: [`output_layer`].
    fn output(&self) -> Linear;

    /// What everybody makes of the scene in whole time steps, before its own way is looked at.
    ///
    /// # Shapes
    /// `centred` `[T, P, 2]`, positions (m) relative to the scene's mean so far; `seen` during one time step or T -> `[T, P, any
    /// width]`, the input `scene` of [`step`](Self::step).
    fn scene(&self, backend: &B, centred: &B::Tokens, seen: &B::Seen) -> B::Tokens;

    /// One time step: the features of everybody, and what is kept for later steps.
    ///
    /// # Shapes
    /// `relative` `[B, P, StarConfig::temporal_inputs]`: positions relative to the goal (or to the last observed position), in the pedestrian's own
    /// frame with its velocity; `scene` `[1 or B, P, any]`; `seen` during one time step -> `[B, P, StarConfig::output_inputs]`.
    fn step(
        &self,
        backend: &B,
        memory: &mut Memory<B>,
        relative: &B::Tokens,
        scene: &B::Tokens,
        seen: &B::Seen,
    ) -> B::Tokens;
}

/// Declares the output layer: features and noise to (a, b, c), or (x, y); in the pedestrian's own frame near L = I.
pub fn output_layer(layout: &mut Layout, config: &StarConfig) -> Linear {
    let inputs = (config.output_inputs() + config.noise_width) as usize;
    let outputs = config.output_width() as usize;
    let bound = 1.0 / (inputs as f64).sqrt();
    let neutral = config.variant.dynamics() && config.frame == NetworkFrame::Goal;
    let scale = if neutral { NEAR_NEUTRAL } else { 1.0 };
    let weight = Initial::Uniform { bound, scale };
    let bias = if neutral {
        Initial::DrawnAway(vec![1.0, 0.0, 1.0])
    } else {
        Initial::Uniform { bound, scale: 1.0 }
    };
    layout.linear_beginning("output_layer", [inputs, outputs], weight, bias)
}
