//! The network: STAR (Yu et al., ECCV 2020) with the output layer of DDL.
//!
//! One frame a step. A walker's position relative to its goal becomes a temporal token, its position
//! relative to the scene becomes a spatial one; the two are fused, look at the neighbours, and look
//! back at the walker's earlier tokens. The result is the walker's token of that frame: it is kept
//! for later frames (the "graph memory") and gives, with the noise, the factor of the metric P.

use crate::StarError;
use crate::config::StarConfig;
use crate::device::ComputeDevice;
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
        let temporal_embedding = Linear::new(init, "input_embedding_layer_temporal", 2, width);
        let spatial_embedding = Linear::new(init, "input_embedding_layer_spatial", 2, width);
        let output_inputs = width + config.noise_width;
        let output = Linear::new(init, "output_layer", output_inputs, config.output_width());
        let fusion = Linear::new(init, "fusion_layer", 2 * width, width);
        let parameters = initializer.finish();
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
    /// `relative` `[B, P, 2]`, positions relative to the goal (or to the last observed position);
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
        token
    }

    /// What the tokens mean: (a, b, c), or (x, y), a walker.
    ///
    /// # Shapes
    /// `tokens` `[B, P, width]`; noise `[1 or B, noise]`, shared by all walkers
    /// -> `[B, P, outputs]`.
    pub(crate) fn emit(&self, tokens: &Tensor, noise: &NoiseInput) -> Tensor {
        let (batch, walkers) = (tokens.size()[0], tokens.size()[1]);
        match noise {
            NoiseInput::Draws(noise) => {
                let noise = noise.unsqueeze(1).expand([batch, walkers, -1], false);
                Tensor::cat(&[tokens, &noise], -1)
                    .linear(&self.output.weight, Some(&self.output.bias))
            }
            NoiseInput::Expected => {
                let (width, noise) = (self.config.model_width, self.config.noise_width);
                let mean = tokens.linear(
                    &self.output.weight.narrow(1, 0, width),
                    Some(&self.output.bias),
                );
                if self.config.variant.dynamics() {
                    expected_factor(&mean, &self.output.weight.narrow(1, width, noise))
                } else {
                    mean
                }
            }
        }
    }
}

/// The noise of the output layer.
#[derive(Debug)]
pub enum NoiseInput {
    /// One vector a hypothesis (or one for all), `[1 or H, noise]`.
    Draws(Tensor),
    /// The expectation over N(0, 1) noise.
    Expected,
}

impl NoiseInput {
    /// Hypotheses that differ by their noise.
    pub(crate) fn count(&self) -> i64 {
        match self {
            Self::Draws(draws) => draws.size()[0],
            Self::Expected => 1,
        }
    }
}

/// The Cholesky factor of E[L L^T] when noise n ~ N(0, I) adds W n to (a, b, c).
///
/// The output is linear in the noise, so E[L L^T] = L0 L0^T + E[D D^T] with D built from W n, whose
/// covariance is C = W W^T: the mean velocity of the noisy walkers, in closed form. The noise-free L0
/// alone would be too slow: P is quadratic in L, and the noise's share of it is not small.
///
/// # Shapes
/// `mean` `[.., 3]`, `weight` `[3, noise]` -> `[.., 3]`.
fn expected_factor(mean: &Tensor, weight: &Tensor) -> Tensor {
    let covariance = weight.matmul(&weight.transpose(0, 1));
    let c = |i: i64, j: i64| covariance.get(i).get(j);
    let l = |i: i64| mean.narrow(-1, i, 1);
    let (a, b, d) = (l(0), l(1), l(2));
    let p11 = a.square() + c(0, 0);
    let p12 = &a * &b + c(0, 1);
    let p22 = b.square() + d.square() + c(1, 1) + c(2, 2);
    let first = p11.clamp_min(SMALLEST_PIVOT).sqrt();
    let below = p12 / &first;
    let second = (p22 - below.square()).clamp_min(SMALLEST_PIVOT).sqrt();
    Tensor::cat(&[first, below, second], -1)
}

/// Pivots of the expected metric below this count as this, in m/s.
const SMALLEST_PIVOT: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use super::*;

    /// The metric of the factor is the mean of the noisy metrics.
    #[test]
    fn the_expected_factor_is_that_of_the_mean_metric() {
        tch::manual_seed(3);
        let options = (Kind::Double, Device::Cpu);
        let (mean, weight) = (
            Tensor::randn([3], options),
            Tensor::randn([3, 16], options) * 0.1,
        );
        let metric = |factors: &Tensor| {
            let entry = |i: i64| factors.select(-1, i);
            let (a, b, c) = (entry(0), entry(1), entry(2));
            Tensor::stack(&[a.square(), &a * &b, b.square() + c.square()], -1)
        };
        let noise = Tensor::randn([400_000, 16], options);
        let sampled = metric(&(&mean + noise.matmul(&weight.transpose(0, 1))));
        let sampled = sampled.mean_dim([0i64].as_slice(), false, None::<Kind>);
        let expected = metric(&expected_factor(&mean, &weight));
        // standard error of the sampled mean: about 2e-3
        let difference = (sampled - expected).abs().max().double_value(&[]);
        assert!(difference < 1e-2, "{difference}");
    }
}
