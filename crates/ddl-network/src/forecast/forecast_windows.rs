//! The interface of a forecasting network, independent of its implementation.

use crate::forecast::batch::{BatchRollout, CrowdOrder, ForecastBatch, batches};
use crate::forecast::rollout::{Noise, StepRule, WindowRollout};
use crate::weights::Weights;
use crate::{NetworkError, StarConfig};
use ddl_core::{Position, Window};
use std::fmt::Debug;

/// A forecasting network: kernels on the CPU, or libtorch in `ddl-star`.
pub trait ForecastWindows: Debug + Send + Sync {
    /// Sizes and constants.
    fn config(&self) -> &StarConfig;

    /// A copy of the weights.
    ///
    /// # Errors
    /// If the weights cannot be copied from their device.
    fn copy_weights(&self) -> Result<Weights, NetworkError>;

    /// Largest number of pedestrians in a batch of several windows. The default is enough for efficient matrix products
    /// of the kernels.
    fn pedestrians_at_once(&self) -> usize {
        64
    }

    /// How the pedestrians of a crowd are sorted for [`roll_out`](Self::roll_out).
    fn crowd_order(&self) -> CrowdOrder {
        CrowdOrder::Strips
    }

    /// Forecasts one batch of windows.
    ///
    /// # Errors
    /// If the implementation fails.
    fn roll_out(&self, batch: &ForecastBatch<'_>) -> Result<BatchRollout, NetworkError>;

    /// Forecasts 12 time steps for every pedestrian of every window. Does not read the true future.
    ///
    /// # Shapes
    /// `goals[w][i]` holds the goals of pedestrian i of window w. All pedestrians have the same number of goals. There
    /// is one hypothesis for each goal or, with a single goal, for each noise vector. `shares[w][i]`, 0 to 1, is the
    /// share of the network's metric in the bounded steps of pedestrian i; `None` means 1.
    ///
    /// # Errors
    /// [`NetworkError::Shape`] if goals or shares do not fit the windows, or if there are several goals and several
    /// noise vectors.
    fn forecast_windows(
        &self,
        windows: &[Window],
        goals: &[Vec<Vec<Position>>],
        noise: Noise,
        rule: StepRule,
        shares: Option<&[Vec<f64>]>,
    ) -> Result<Vec<WindowRollout>, NetworkError> {
        let noise_width = self.config().noise_width as usize;
        let mut rollouts = Vec::with_capacity(windows.len());
        let sizes = (self.pedestrians_at_once(), self.crowd_order());
        for batch in batches(windows, goals, (noise, noise_width), rule, shares, sizes)? {
            rollouts.extend(batch.windows_of(&self.roll_out(&batch)?));
        }
        Ok(rollouts)
    }
}
