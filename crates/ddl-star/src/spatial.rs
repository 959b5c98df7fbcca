//! Spatial encoder: a few layers in which the walkers of one frame look at each other.

use crate::config::StarConfig;
use crate::encoder_layer::EncoderLayer;
use crate::neighbours::Seen;
use crate::parameters::Initializer;
use crate::pass::Pass;
use crate::tokens::Tokens;

#[derive(Debug)]
pub(crate) struct SpatialEncoder {
    layers: Vec<EncoderLayer>,
}

impl SpatialEncoder {
    pub(crate) fn new(init: &mut Initializer, name: &str, config: &StarConfig) -> Self {
        let layer = |index: usize| format!("{name}.transformer_encoder.layers.{index}");
        let layers = (0..config.spatial_layers)
            .map(|index| EncoderLayer::new(init, &layer(index), config, config.spatial_dropout))
            .collect();
        Self { layers }
    }

    /// # Shapes
    /// `x` `[B, P, width]`; `seen` during one frame or B -> `[B, P, width]`.
    pub(crate) fn forward(&self, x: &Tokens, seen: &Seen, pass: &Pass) -> Tokens {
        self.layers
            .iter()
            .fold(x.shared(), |x, layer| layer.among_walkers(&x, seen, pass))
    }
}
