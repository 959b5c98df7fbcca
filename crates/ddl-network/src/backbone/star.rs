//! STAR (Yu et al., ECCV 2020), one time step at a time. Only the output of the newest token is used, and earlier
//! tokens never change. So each time step needs one query, and keys and values of earlier tokens are cached.

use crate::StarConfig;
use crate::backbone::features::{Backbone, output_layer};
use crate::backend::{Backend, Memory};
use crate::config::NetworkFrame;
use crate::weights::{EncoderLayer, Layout, Linear, Sizes};

/// The backbone of the paper.
#[derive(Debug, Clone)]
pub struct Star {
    frame: NetworkFrame,
    temporal_embedding: Linear,
    spatial_embedding: Linear,
    spatial: [Vec<EncoderLayer>; 2],
    temporal: [EncoderLayer; 2],
    fusion: Linear,
    output: Linear,
}

impl Star {
    /// Declares its layers.
    pub fn new(layout: &mut Layout, config: &StarConfig) -> Self {
        let sizes = Sizes {
            width: config.model_width as usize,
            heads: config.heads as usize,
            hidden: config.feed_forward_width as usize,
        };
        let width = sizes.width;
        let spatial = [1, 2].map(|encoder| {
            let layer = |index: usize| format!("spatial_encoder_{encoder}.transformer_encoder.layers.{index}");
            (0..config.spatial_layers)
                .map(|index| layout.encoder_layer(&layer(index), sizes, config.spatial_dropout))
                .collect()
        });
        let temporal =
            [1, 2].map(|encoder| layout.encoder_layer(&format!("temporal_encoder_{encoder}.layers.0"), sizes, 0.0));
        let inputs = config.temporal_inputs() as usize;
        // The order decides which random numbers become the initial weights of a layer.
        let temporal_embedding = layout.linear("input_embedding_layer_temporal", inputs, width);
        let spatial_embedding = layout.linear("input_embedding_layer_spatial", 2, width);
        let output = output_layer(layout, config);
        let fusion = layout.linear("fusion_layer", 2 * width, width);
        Self { frame: config.frame, temporal_embedding, spatial_embedding, spatial, temporal, fusion, output }
    }
}

fn spatial_encoder<B: Backend>(backend: &B, layers: &[EncoderLayer], x: &B::Tokens, seen: &B::Seen) -> B::Tokens {
    layers.iter().fold(x.clone(), |x, &layer| backend.spatial_attention(layer, &x, seen))
}

impl<B: Backend> Backbone<B> for Star {
    fn output(&self) -> Linear {
        self.output
    }

    fn scene(&self, backend: &B, centred: &B::Tokens, seen: &B::Seen) -> B::Tokens {
        let embedded = backend.relu(&backend.linear(self.spatial_embedding, centred));
        spatial_encoder(backend, &self.spatial[0], &embedded, seen)
    }

    fn step(
        &self,
        backend: &B,
        memory: &mut Memory<B>,
        relative: &B::Tokens,
        scene: &B::Tokens,
        seen: &B::Seen,
    ) -> B::Tokens {
        memory.caches.resize_with(self.temporal.len(), Vec::new);
        let [first, second] = self.temporal;
        let newest = backend.relu(&backend.linear(self.temporal_embedding, relative));
        let temporal = backend.temporal_attention(first, &newest, &memory.caches[0]);
        let scene = backend.repeated(scene, backend.entries(&temporal));
        let fused = backend.linear(self.fusion, &backend.concatenate(&temporal, &scene));
        let among = spatial_encoder(backend, &self.spatial[1], &fused, seen);
        let token = backend.temporal_attention(second, &among, &memory.caches[1]);
        for (cache, layer) in memory.caches.iter_mut().zip(self.temporal) {
            backend.remember(layer, &token, cache);
        }
        match self.frame {
            NetworkFrame::World => token,
            NetworkFrame::Goal => backend.concatenate(&token, relative),
        }
    }
}
