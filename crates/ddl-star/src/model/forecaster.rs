//! Forecasts of the network on libtorch, through the trait `ForecastWindows`.

use crate::StarError;
use crate::model::backend::TorchBackend;
use crate::model::batch::WindowBatch;
use crate::model::emission::NoiseInput;
use crate::model::network::TorchNetwork;
use crate::model::numbers::{arrays, tensor};
use crate::model::rollout::Rollout;
use crate::model::tensor_backend::TensorEngine;
use ddl_core::{OBSERVED, Window};
use ddl_network::backend::Mode;
use ddl_network::weights::Weights;
use ddl_network::{BatchRollout, CrowdOrder, ForecastBatch, ForecastWindows, NetworkError, StarConfig};
use std::sync::{Mutex, PoisonError};
use tch::{Device, Kind};

/// Many enough that a graphics card is busy for longer than launching its kernels takes.
const PEDESTRIANS_AT_ONCE: usize = 2048;

impl TorchNetwork {
    /// This network, computed by libtorch, as a `ForecastWindows`.
    #[must_use]
    pub fn into_forecaster(self) -> Box<dyn ForecastWindows> {
        Box::new(TorchForecaster {
            config: self.layers.config.clone(),
            options: (self.kind, self.device),
            network: Mutex::new(self),
        })
    }

    fn roll_out_batch(&self, batch: &ForecastBatch<'_>, mut scenes: WindowBatch) -> Result<BatchRollout, StarError> {
        let _guard = tch::no_grad_guard();
        let (device, kind) = (self.device, self.kind);
        let tensor = |values: &[f64], shape: &[i64]| tensor(values, shape, (kind, device));
        let pedestrians = scenes.pedestrians() as i64;
        if let Some(shares) = &batch.shares {
            scenes.share = tensor(shares, &[1, pedestrians, 1])?;
        }
        let goals = batch.goals.concat();
        let shape = [batch.goals.len() as i64, pedestrians, 2];
        let goals = tensor(goals.as_flattened(), &shape)?;
        let noise = match &batch.noise {
            None => NoiseInput::Expected,
            Some(draws) => {
                let shape = [batch.noise_vectors as i64, self.layers.config.noise_width];
                NoiseInput::Draws(tensor(draws, &shape)?)
            }
        };
        let torch = TorchBackend::new(self.parameters(), Mode::Evaluate);
        let pass = TensorEngine::Torch(&torch);
        let Rollout { positions, factors } = self.layers.roll_out(&scenes, &goals, &noise, batch.rule, pass);
        Ok(BatchRollout {
            hypotheses: positions.size()[1] as usize,
            positions: arrays(&positions)?,
            factors: factors.as_ref().map(arrays).transpose()?,
        })
    }
}

/// Forecasts by libtorch. Tensors can move between threads but not be shared, so one forecast runs at a time.
#[derive(Debug)]
struct TorchForecaster {
    config: StarConfig,
    options: (Kind, Device),
    network: Mutex<TorchNetwork>,
}

impl ForecastWindows for TorchForecaster {
    fn config(&self) -> &StarConfig {
        &self.config
    }

    fn copy_weights(&self) -> Result<Weights, NetworkError> {
        Ok(self.network.lock().unwrap_or_else(PoisonError::into_inner).parameters().to_weights()?)
    }

    fn pedestrians_at_once(&self) -> usize {
        PEDESTRIANS_AT_ONCE
    }

    fn crowd_order(&self) -> CrowdOrder {
        CrowdOrder::Curve
    }

    fn roll_out(&self, batch: &ForecastBatch<'_>) -> Result<BatchRollout, NetworkError> {
        // Made on several threads before the lock: a thread that waits for others inside it could be given another
        // forecast, which would wait for the lock.
        let views: Vec<&Window> = batch.windows.iter().collect();
        let (kind, device) = self.options;
        let scenes = WindowBatch::new(&views, OBSERVED, OBSERVED, self.config.neighbour_box, device, kind)?;
        let _ = scenes.seen(0..OBSERVED);
        Ok(self.network.lock().unwrap_or_else(PoisonError::into_inner).roll_out_batch(batch, scenes)?)
    }
}
