//! The trait of a backbone, and the output layer after it.

use crate::StarConfig;
use crate::backend::{Backend, Memory};
use crate::config::NetworkFrame;
use crate::weights::{Initial, Layout, Linear};
use std::fmt::Debug;

/// Scale of the initial weights of an output layer whose initial output is near L = I.
const NEAR_NEUTRAL: f64 = 0.1;

/// A network that turns positions into features, one time step after the other. `docs/extending.md` adds one.
pub trait Backbone<B: Backend>: Debug + Send + Sync {
    /// The output layer that the backbone declared with [`output_layer`].
    fn output(&self) -> Linear;

    /// The part of the computation that depends on the scene, but not on a goal or on earlier time steps.
    ///
    /// # Shapes
    /// `centred` `[T, P, 2]`: positions (m) relative to the mean over the scene and all time steps so far. `seen`:
    /// masks of one time step, or of T. Returns `[T, P, any width]`, the input `scene` of [`step`](Self::step).
    fn scene(&self, backend: &B, centred: &B::Tokens, seen: &B::Seen) -> B::Tokens;

    /// One time step: returns the features of all pedestrians, and adds to `memory` what later steps need.
    ///
    /// # Shapes
    /// `relative` `[B, P, StarConfig::temporal_inputs]`: positions relative to the goal (or to the last observed
    /// position), in the pedestrian's own frame with its velocity. `scene` `[1 or B, P, any width]`. `seen`: masks of
    /// one time step. Returns `[B, P, StarConfig::output_inputs]`.
    fn step(
        &self,
        backend: &B,
        memory: &mut Memory<B>,
        relative: &B::Tokens,
        scene: &B::Tokens,
        seen: &B::Seen,
    ) -> B::Tokens;
}

/// Declares the output layer, from features and noise to (a, b, c) or (x, y). In the pedestrian's own frame the initial
/// output is near L = I.
pub fn output_layer(layout: &mut Layout, config: &StarConfig) -> Linear {
    let inputs = (config.output_inputs() + config.noise_width) as usize;
    let outputs = config.output_width() as usize;
    let bound = 1.0 / (inputs as f64).sqrt();
    let neutral = config.variant.dynamics() && config.frame == NetworkFrame::Goal;
    let scale = if neutral { NEAR_NEUTRAL } else { 1.0 };
    let weight = Initial::Uniform { bound, scale };
    let bias = if neutral { Initial::Fixed(vec![1.0, 0.0, 1.0]) } else { Initial::Uniform { bound, scale: 1.0 } };
    layout.linear_with_initial("output_layer", [inputs, outputs], weight, bias)
}
