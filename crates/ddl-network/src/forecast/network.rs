//! The forecasting network on plain numbers.

use super::batch::{BatchRollout, ForecastBatch};
use super::course::BatchCourse;
use super::emission::NoiseSpread;
use super::forecast_windows::ForecastWindows;
use crate::backbone::{Backbone, Perceptron, Star};
use crate::backend::{Backend as _, Buffer, KernelBackend, Kernels, Memory, Rows};
use crate::config::BackboneKind;
use crate::seed::{Stage, stream};
use crate::weights::{Layout, Linear, Weights};
use crate::{NetworkError, Precision, StarConfig};
use ddl_data::{HORIZON, OBSERVED};
use std::rc::Rc;
use std::sync::Arc;

/// The forecasting network, computed by kernels on the CPU in `f32`.
///
/// # Numerics
/// A window's rollout has the same bits alone and among others, and with every number of threads.
#[derive(Debug)]
pub struct MotionNetwork {
    config: StarConfig,
    weights: Weights,
    kernels: Arc<Kernels>,
    backbone: Box<dyn Backbone<KernelBackend>>,
    output: Linear,
    spread: Option<NoiseSpread>,
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
    /// [`NetworkError::Config`] when the configuration is out of range, [`NetworkError::Shape`] when the weights are of another layout,
    /// and those of `read`.
    pub fn reading(
        config: StarConfig,
        read: impl FnOnce(&Arc<Layout>) -> Result<Weights, NetworkError>,
    ) -> Result<Self, NetworkError> {
        match config.backbone {
            BackboneKind::Star => Self::build(config, Star::new, read),
            BackboneKind::Perceptron => Self::build(config, Perceptron::new, read),
        }
    }

    /// A network with a backbone of one's own, and seeded initial weights; `make` declares its layers.
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
        weights.ensure_of(&layout)?;
        let kernels = Kernels::new(&layout, weights.numbers(), Precision::F32);
        Ok(Self {
            spread: spread(&config, &weights, output),
            config,
            weights,
            kernels: Arc::new(kernels),
            backbone: Box::new(backbone),
            output,
        })
    }

    /// The same network with other learned numbers.
    ///
    /// # Errors
    /// [`NetworkError::Shape`] when they are of another layout.
    pub fn with_weights(self, weights: Weights) -> Result<Self, NetworkError> {
        weights.ensure_of(self.weights.layout())?;
        let layout = weights.layout();
        let kernels = Kernels::new(layout, weights.numbers(), self.precision());
        Ok(Self {
            spread: spread(&self.config, &weights, self.output),
            kernels: Arc::new(kernels),
            weights,
            ..self
        })
    }

    /// The same network, whose feed-forward blocks are computed in that precision.
    #[must_use]
    pub fn in_precision(self, precision: Precision) -> Self {
        let kernels = Kernels::new(self.weights.layout(), self.weights.numbers(), precision);
        Self {
            kernels: Arc::new(kernels),
            ..self
        }
    }

    /// The learned numbers.
    pub fn weights(&self) -> &Weights {
        &self.weights
    }

    fn emit(&self, backend: &KernelBackend, features: &Rc<Rows>, noise: &Rc<Rows>) -> Buffer {
        let emitted = backend.linear(self.output, &backend.beside(features, noise));
        Buffer::copy(&emitted)
    }

    /// The noise beside each pedestrian's features, `[H, P, noise]`: zeros where its expectation is added afterwards.
    fn noise(&self, batch: &ForecastBatch<'_>) -> Rc<Rows> {
        let width = self.config.noise_width as usize;
        let shape = [batch.hypotheses(), batch.pedestrians(), width];
        let mut numbers = Buffer::zeros(shape.iter().product());
        if let Some(draws) = &batch.noise {
            for (h, entry) in numbers.chunks_exact_mut(shape[1] * width).enumerate() {
                let vector = &draws[h % batch.noise_vectors * width..][..width];
                for row in entry.chunks_exact_mut(width) {
                    for (number, &drawn) in row.iter_mut().zip(vector) {
                        *number = drawn as f32;
                    }
                }
            }
        }
        Rc::new(Rows::new(shape, numbers))
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

    fn precision(&self) -> Precision {
        self.kernels.precision()
    }

    fn roll_out(&self, batch: &ForecastBatch<'_>) -> Result<BatchRollout, NetworkError> {
        let backend = KernelBackend::forward_only(Arc::clone(&self.kernels));
        let mut course = BatchCourse::new(batch, &self.config);
        let seen = course.seen(0..OBSERVED);
        let scene = self
            .backbone
            .scene(&backend, &course.observed_centred(), &seen);
        let mut memory = Memory::default();
        let mut features = None;
        for t in 0..OBSERVED {
            let (relative, seen) = (course.observed_relative(t), course.seen(t..t + 1));
            let scene = backend.entry(&scene, t);
            let step = self
                .backbone
                .step(&backend, &mut memory, &relative, &scene, &seen);
            features = Some(step);
        }
        let hypotheses = batch.hypotheses();
        // There is a last observed step.
        let Some(features) = features else {
            unreachable!("{OBSERVED} observed time steps")
        };
        let mut features = if backend.entries(&features) < hypotheses {
            memory = memory.repeated(&backend, hypotheses);
            backend.repeated(&features, hypotheses)
        } else {
            features
        };
        let noise = self.noise(batch);
        let spread = self.spread.filter(|_| batch.noise.is_none());
        let seen = course.seen(OBSERVED - 1..OBSERVED);
        let (mut positions, mut factors) = (Vec::new(), Vec::new());
        for t in 0..HORIZON {
            let mut emitted = self.emit(&backend, &features, &noise);
            if let Some(spread) = spread {
                let (factors, _) = emitted.as_chunks_mut::<3>();
                for factor in factors {
                    *factor = spread.expected_factor(*factor);
                }
            }
            course.advance(&mut emitted, (t, HORIZON - t));
            positions.extend(course.positions().iter().map(|p| p.map(f64::from)));
            if self.spread.is_some() {
                let (world, _) = emitted.as_chunks::<3>();
                factors.extend(world.iter().map(|factor| factor.map(f64::from)));
            }
            if t + 1 < HORIZON {
                let centred = course.centred(OBSERVED + t + 1);
                let scene = self.backbone.scene(&backend, &centred, &seen);
                let relative = course.newest_relative();
                features = self
                    .backbone
                    .step(&backend, &mut memory, &relative, &scene, &seen);
            }
        }
        Ok(BatchRollout {
            hypotheses,
            positions,
            factors: self.spread.is_some().then_some(factors),
        })
    }
}
