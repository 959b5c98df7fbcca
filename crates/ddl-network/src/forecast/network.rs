//! The forecasting network on the CPU.

use crate::backbone::{Backbone, Perceptron, Star};
use crate::backend::{KernelBackend, Kernels};
use crate::config::BackboneKind;
use crate::forecast::emission::NoiseSpread;
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
    pub(super) weights: Weights,
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
        Self::reading(config, |layout| Ok(Weights::seeded(layout, seed)))
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
            BackboneKind::Star => Self::with_backbone(config, Star::new, read),
            BackboneKind::Perceptron => Self::with_backbone(config, Perceptron::new, read),
        }
    }

    /// A network with a custom backbone, whose layers `make` declares, and the weights that `read` gives for them, such
    /// as [`Weights::seeded`].
    ///
    /// # Errors
    /// As [`reading`](Self::reading).
    pub fn with_backbone<T: Backbone<KernelBackend> + 'static>(
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
        let last = &weights.numbers()[output.span()];
        let noise = config.noise_width as usize;
        let dynamics = config.variant.dynamics();
        Ok(Self {
            spread: dynamics.then(|| NoiseSpread::of(last, output.inputs, noise)),
            config,
            weights,
            kernels: Arc::new(kernels),
            backbone: Box::new(backbone),
            output,
        })
    }
}
