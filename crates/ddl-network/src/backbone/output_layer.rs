//! From features and noise to what shapes a step.

use crate::StarConfig;
use crate::config::NetworkFrame;
use crate::weights::{Initial, Layout, Linear};

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

/// How much smaller the first weights of an output layer are that begins near L = I.
const NEAR_NEUTRAL: f64 = 0.1;
