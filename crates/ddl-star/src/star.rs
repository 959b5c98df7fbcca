//! The network: STAR (Yu et al., ECCV 2020) with the output layer of DDL.
//!
//! One frame a step. A walker's position relative to its goal becomes a temporal token, its position
//! relative to the scene becomes a spatial one; the two are fused, look at the neighbours, and look
//! back at the walker's earlier tokens. The result is the walker's token of that frame: it is kept
//! for later frames (the "graph memory") and gives, with the noise, the factor of the metric P.

use crate::StarError;
use crate::config::{Frame, StarConfig};
use crate::device::ComputeDevice;
use crate::emission::{Emission, NoiseInput};
use crate::layers::{Linear, Mode};
use crate::neighbours::Seen;
use crate::parameters::{Initializer, Parameters};
use crate::pass::Pass;
use crate::precision::Precision;
use crate::seed::{Stage, stream};
use crate::spatial::SpatialEncoder;
use crate::temporal::{TemporalEncoder, TemporalMemory};
use crate::tokens::Tokens;
use tch::{Device, Kind, Tensor};

/// STAR with the three outputs (a, b, c) of the Cholesky factor (paper eq. 12), or two for the
/// variants without dynamics.
#[derive(Debug)]
pub struct StarNetwork {
    config: StarConfig,
    parameters: Parameters,
    device: Device,
    kind: Kind,
    precision: Precision,
    temporal_embedding: Linear,
    spatial_embedding: Linear,
    spatial_encoder_1: SpatialEncoder,
    spatial_encoder_2: SpatialEncoder,
    temporal_encoder_1: TemporalEncoder,
    temporal_encoder_2: TemporalEncoder,
    fusion: Linear,
    output: Linear,
}

/// How much smaller the first weights of an output layer are that begins near L = I.
const NEAR_NEUTRAL: f64 = 0.1;

/// Sets the output layer to L = I and little else: the neutral motion, from which training departs.
fn start_neutral(output: &Linear) {
    let _guard = tch::no_grad_guard();
    let identity = Tensor::from_slice(&[1.0, 0.0, 1.0])
        .to_kind(output.bias.kind())
        .to_device(output.bias.device());
    output.bias.shallow_clone().copy_(&identity);
    let _ = output.weight.shallow_clone().g_mul_scalar_(NEAR_NEUTRAL);
}

/// What both temporal encoders remember of the frames so far.
#[derive(Debug, Default)]
pub(crate) struct GraphMemory {
    first: TemporalMemory,
    second: TemporalMemory,
}

impl GraphMemory {
    /// Repeats a single batch entry `batch` times, without copying.
    pub(crate) fn expand_batch(&self, batch: i64) -> Self {
        Self {
            first: self.first.expand_batch(batch),
            second: self.second.expand_batch(batch),
        }
    }
}

impl StarNetwork {
    /// A network with seeded initial values, on a device, in f32.
    ///
    /// # Errors
    /// [`StarError::Config`] when the configuration is out of range.
    pub fn new(config: StarConfig, seed: u64, device: ComputeDevice) -> Result<Self, StarError> {
        Self::with_precision(config, seed, device, Kind::Float)
    }

    /// A network in f32 (`Kind::Float`) or f64 (`Kind::Double`).
    ///
    /// # Errors
    /// [`StarError::Config`] when the configuration is out of range.
    pub fn with_precision(
        config: StarConfig,
        seed: u64,
        device: ComputeDevice,
        kind: Kind,
    ) -> Result<Self, StarError> {
        let device = device.torch();
        config.check()?;
        let mut initializer = Initializer::new(stream(seed, Stage::Weights, 0), device, kind);
        let init = &mut initializer;
        let width = config.model_width;
        let spatial_encoder_1 = SpatialEncoder::new(init, "spatial_encoder_1", &config);
        let spatial_encoder_2 = SpatialEncoder::new(init, "spatial_encoder_2", &config);
        let temporal_encoder_1 = TemporalEncoder::new(init, "temporal_encoder_1", &config);
        let temporal_encoder_2 = TemporalEncoder::new(init, "temporal_encoder_2", &config);
        let temporal_embedding = Linear::new(
            init,
            "input_embedding_layer_temporal",
            config.temporal_inputs(),
            width,
        );
        let spatial_embedding = Linear::new(init, "input_embedding_layer_spatial", 2, width);
        let output_inputs = config.output_inputs() + config.noise_width;
        let output = Linear::new(init, "output_layer", output_inputs, config.output_width());
        let fusion = Linear::new(init, "fusion_layer", 2 * width, width);
        let parameters = initializer.finish();
        if config.variant.dynamics() && config.frame == Frame::Goal {
            start_neutral(&output);
        }
        Ok(Self {
            config,
            parameters,
            device,
            kind,
            precision: Precision::F32,
            temporal_embedding,
            spatial_embedding,
            spatial_encoder_1,
            spatial_encoder_2,
            temporal_encoder_1,
            temporal_encoder_2,
            fusion,
            output,
        })
    }

    /// The same network, whose feed-forward blocks are computed in that precision; where libtorch is asked for gradients,
    /// and in training, they are `f32`.
    ///
    /// # Errors
    /// [`StarError::Config`] for another than [`Precision::F32`] in f64, and elsewhere than on the CPU.
    pub fn in_precision(self, precision: Precision) -> Result<Self, StarError> {
        if precision != Precision::F32 && (self.device, self.kind) != (Device::Cpu, Kind::Float) {
            return Err(StarError::Config {
                field: "precision",
                value: precision.name().to_owned(),
                rule: "f32, unless the network computes in f32 on the CPU",
            });
        }
        Ok(Self { precision, ..self })
    }

    /// Size and constants.
    pub fn config(&self) -> &StarConfig {
        &self.config
    }

    /// The learned tensors.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Where the network computes.
    pub fn device(&self) -> Device {
        self.device
    }

    /// Precision of the products in its feed-forward blocks.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Kind of all its numbers.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// A pass through the network that ends before gradients: by our own kernels where nobody wants them.
    pub(crate) fn pass(&self, mode: Mode) -> Pass {
        // What is made of a learned tensor wants a gradient, unless libtorch was told otherwise.
        if self.fusion.bias.square().requires_grad() {
            Pass::plain(mode)
        } else {
            Pass::forward_only(mode, &self.parameters, self.precision)
        }
    }

    /// Spatial tokens of whole frames: embedding and first spatial encoder.
    ///
    /// # Shapes
    /// `centred` `[F, P, 2]`, positions relative to the scene's mean so far; `seen`
    /// during one frame or F -> `[F, P, width]`.
    pub(crate) fn spatial_tokens(&self, centred: &Tokens, seen: &Seen, pass: &Pass) -> Tokens {
        let embedded = self.spatial_embedding.of_tokens(centred, pass).relu(pass);
        self.spatial_encoder_1.forward(&embedded, seen, pass)
    }

    /// One frame: the walkers' new tokens, which are also remembered.
    ///
    /// # Shapes
    /// `relative` `[B, P, inputs]`, positions relative to the goal (or to the last observed position), in the walkers' own frames
    /// with the velocity;
    /// `spatial` `[1 or B, P, width]`; `seen` during one frame -> `[B, P, width]`.
    pub(crate) fn step(
        &self,
        memory: &mut GraphMemory,
        relative: &Tokens,
        spatial: &Tokens,
        seen: &Seen,
        pass: &Pass,
    ) -> Tokens {
        let newest = self.temporal_embedding.of_tokens(relative, pass).relu(pass);
        let temporal = self
            .temporal_encoder_1
            .forward(&newest, &memory.first, pass);
        let spatial = spatial.repeated(temporal.entries(), pass);
        let fused = self
            .fusion
            .of_tokens(&temporal.beside(&spatial, pass), pass);
        let among = self.spatial_encoder_2.forward(&fused, seen, pass);
        let token = self
            .temporal_encoder_2
            .forward(&among, &memory.second, pass);
        memory
            .first
            .push(self.temporal_encoder_1.remember(&token, pass));
        memory
            .second
            .push(self.temporal_encoder_2.remember(&token, pass));
        match self.config.frame {
            Frame::World => token,
            Frame::Goal => token.beside(relative, pass),
        }
    }

    /// What the output layer makes of tokens under this noise.
    pub(crate) fn emission<'a>(&'a self, noise: &'a NoiseInput) -> Emission<'a> {
        Emission::new(&self.output, noise, &self.config)
    }
}
