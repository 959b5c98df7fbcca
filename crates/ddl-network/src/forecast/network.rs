//! The forecasting network on the CPU.

use crate::backbone::{Backbone, Perceptron, Star};
use crate::backend::{KernelBackend, Kernels};
use crate::config::BackboneKind;
use crate::forecast::batch::{BatchRollout, ForecastBatch};
use crate::forecast::emission::NoiseSpread;
use crate::forecast::forecast_windows::ForecastWindows;
use crate::forecast::pass::Pass;
use crate::seed::{Stage, stream};
use crate::weights::{Layout, Linear, Weights};
use crate::{NetworkError, StarConfig};
use std::sync::Arc;

/// The forecasting network, computed by kernels on the CPU in `f32`.
///
/// # Numerics
/// The rollout of a window has the same bits alone and together with other windows, with any number of threads.
#[derive(Debug)]
pub struct MotionNetwork {
    pub(super) config: StarConfig,
    weights: Weights,
    pub(super) kernels: Arc<Kernels>,
    pub(super) backbone: Box<dyn Backbone<KernelBackend>>,
    pub(super) output: Linear,
    /// Needed for the expectation over the noise; `None` for the variants without dynamics.
    pub(super) spread: Option<NoiseSpread>,
}

impl MotionNetwork {
    /// A network with seeded initial weights.
    ///
    /// # Errors
    /// [`NetworkError::Config`] when the configuration is out of range.
    pub fn new(config: StarConfig, seed: u64) -> Result<Self, NetworkError> {
        Self::reading(config, |layout| Ok(initial(layout, seed)))
    }

    /// A network with the weights that `read` gives for its layout.
    ///
    /// # Errors
    /// [`NetworkError::Config`] if the configuration is out of range, [`NetworkError::Shape`] if the weights have
    /// another layout, and the errors of `read`.
    pub fn reading(
        config: StarConfig,
        read: impl FnOnce(&Arc<Layout>) -> Result<Weights, NetworkError>,
    ) -> Result<Self, NetworkError> {
        match config.backbone {
            BackboneKind::Star => Self::build(config, Star::new, read),
            BackboneKind::Perceptron => Self::build(config, Perceptron::new, read),
        }
    }

    /// A network with a custom backbone and seeded initial weights; `make` declares the layers.
    ///
    /// # Errors
    /// [`NetworkError::Config`] when the configuration is out of range.
    pub fn with_backbone<T: Backbone<KernelBackend> + 'static>(
        config: StarConfig,
        seed: u64,
        make: impl FnOnce(&mut Layout, &StarConfig) -> T,
    ) -> Result<Self, NetworkError> {
        Self::build(config, make, |layout| Ok(initial(layout, seed)))
    }

    fn build<T: Backbone<KernelBackend> + 'static>(
        config: StarConfig,
        make: impl FnOnce(&mut Layout, &StarConfig) -> T,
        read: impl FnOnce(&Arc<Layout>) -> Result<Weights, NetworkError>,
    ) -> Result<Self, NetworkError> {
        config.check()?;
        let mut layout = Layout::default();
        let backbone = make(&mut layout, &config);
        let output = backbone.output();
        let layout = Arc::new(layout);
        let weights = read(&layout)?;
        weights.check_layout(&layout)?;
        let kernels = Kernels::new(&layout, weights.numbers());
        Ok(Self {
            spread: spread(&config, &weights, output),
            config,
            weights,
            kernels: Arc::new(kernels),
            backbone: Box::new(backbone),
            output,
        })
    }

    /// The same network with other weights.
    ///
    /// # Errors
    /// [`NetworkError::Shape`] if they have another layout.
    pub fn with_weights(self, weights: Weights) -> Result<Self, NetworkError> {
        weights.check_layout(self.weights.layout())?;
        let layout = weights.layout();
        let kernels = Kernels::new(layout, weights.numbers());
        Ok(Self {
            spread: spread(&self.config, &weights, self.output),
            kernels: Arc::new(kernels),
            weights,
            ..self
        })
    }
}

fn initial(layout: &Arc<Layout>, seed: u64) -> Weights {
    Weights::initial(layout, stream(seed, Stage::Weights, 0))
}

fn spread(config: &StarConfig, weights: &Weights, output: Linear) -> Option<NoiseSpread> {
    let numbers = &weights.numbers()[output.span()];
    let noise = config.noise_width as usize;
    let dynamics = config.variant.dynamics();
    dynamics.then(|| NoiseSpread::of(numbers, output.inputs, noise))
}

impl ForecastWindows for MotionNetwork {
    fn config(&self) -> &StarConfig {
        &self.config
    }

    fn copy_weights(&self) -> Result<Weights, NetworkError> {
        Ok(self.weights.clone())
    }

    fn roll_out(&self, batch: &ForecastBatch<'_>) -> Result<BatchRollout, NetworkError> {
        Ok(Pass::new(self, batch).roll_out())
    }
}
