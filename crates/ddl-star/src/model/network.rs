//! The forecasting network on libtorch: for training, for CUDA, and as the reference of the kernels.

use crate::StarError;
use crate::device::ComputeDevice;
use crate::model::backend::TorchBackend;
use crate::model::parameters::Parameters;
use ddl_network::backbone::{Backbone, Perceptron, Star};
use ddl_network::backend::{KernelBackend, Kernels};
use ddl_network::seed::{Stage, stream};
use ddl_network::weights::{Layout, Linear};
use ddl_network::{BackboneKind, StarConfig};
use std::sync::Arc;
use tch::{Device, Kind, Tensor};

/// The network on libtorch's tensors, on a device.
#[derive(Debug)]
pub struct TorchNetwork {
    pub(crate) layers: Layers,
    parameters: Parameters,
    pub(crate) device: Device,
    pub(crate) kind: Kind,
}

/// The layers of a network. Threads can share them, but not its tensors.
#[derive(Debug)]
pub(crate) struct Layers {
    pub(crate) config: StarConfig,
    pub(super) on_tensors: Box<dyn Backbone<TorchBackend>>,
    pub(super) on_rows: Box<dyn Backbone<KernelBackend>>,
    pub(super) output: Linear,
}

impl TorchNetwork {
    /// A network with seeded initial values, on a device, in f32.
    ///
    /// # Errors
    /// [`StarError::Network`] when the configuration is out of range.
    pub fn new(config: StarConfig, seed: u64, device: ComputeDevice) -> Result<Self, StarError> {
        Self::with_precision(config, seed, device, Kind::Float)
    }

    /// A network in f32 (`Kind::Float`) or f64 (`Kind::Double`).
    ///
    /// # Errors
    /// [`StarError::Network`] when the configuration is out of range.
    pub(crate) fn with_precision(
        config: StarConfig,
        seed: u64,
        device: ComputeDevice,
        kind: Kind,
    ) -> Result<Self, StarError> {
        match config.backbone {
            BackboneKind::Star => Self::with_backbone(config, seed, device, kind, Star::new),
            BackboneKind::Perceptron => Self::with_backbone(config, seed, device, kind, Perceptron::new),
        }
    }

    /// A network with a custom backbone; `make` declares its layers.
    ///
    /// # Errors
    /// [`StarError::Network`] when the configuration is out of range.
    pub fn with_backbone<T>(
        config: StarConfig,
        seed: u64,
        device: ComputeDevice,
        kind: Kind,
        make: impl FnOnce(&mut Layout, &StarConfig) -> T,
    ) -> Result<Self, StarError>
    where
        T: Backbone<TorchBackend> + Backbone<KernelBackend> + Clone + 'static,
    {
        let device = device.0;
        config.check()?;
        let mut layout = Layout::default();
        let backbone = make(&mut layout, &config);
        let output = Backbone::<KernelBackend>::output(&backbone);
        let initial = layout.initial(stream(seed, Stage::Weights, 0));
        Ok(Self {
            layers: Layers { config, on_tensors: Box::new(backbone.clone()), on_rows: Box::new(backbone), output },
            parameters: Parameters::new(layout, &initial, device, kind),
            device,
            kind,
        })
    }

    /// The learned tensors.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// A copy of the output layer's weight for the noise, `[outputs, noise]`, with a gradient of its own.
    pub(crate) fn copy_noise_weight(&self) -> Tensor {
        let weight = &self.parameters.tensors[self.layers.output.tensor];
        let of_noise = weight.narrow(1, self.layers.config.output_inputs(), self.layers.config.noise_width);
        of_noise.detach().copy().set_requires_grad(true)
    }

    /// The weights in the form of the kernels; `None` if the kernels cannot compute it: on other devices than the CPU,
    /// or in f64.
    pub(crate) fn kernels(&self) -> Result<Option<Arc<Kernels>>, StarError> {
        if (self.device, self.kind) != (Device::Cpu, Kind::Float) {
            return Ok(None);
        }
        let weights = self.parameters.to_weights()?;
        Ok(Some(Arc::new(Kernels::new(weights.layout(), weights.numbers()))))
    }
}
