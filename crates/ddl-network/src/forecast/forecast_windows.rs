//! A forecasting network, as everybody sees it who does not compute it.

use super::batch::{BatchRollout, ForecastBatch, batches};
use super::rollout::{Noise, StepRule, WindowRollout};
use crate::weights::Weights;
use crate::{NetworkError, Precision, StarConfig};
use ddl_data::{Position, Window};
use std::fmt::Debug;

/// A forecasting network, whoever computes it.
pub trait ForecastWindows: Debug + Send + Sync {
    /// Size and constants.
    fn config(&self) -> &StarConfig;

    /// A copy of the learned numbers.
    ///
    /// # Errors
    /// When they cannot be fetched from their device.
    fn copy_weights(&self) -> Result<Weights, NetworkError>;

    /// Precision of the products in its feed-forward blocks.
    fn precision(&self) -> Precision;

    /// Forecasts one batch of windows.
    ///
    /// # Errors
    /// When the implementation fails.
    fn roll_out(&self, batch: &ForecastBatch<'_>) -> Result<BatchRollout, NetworkError>;

    /// Forecasts 12 time steps for every pedestrian of every window, without touching the future.
    ///
    /// # Shapes
    /// `goals[w][i]` holds the goals of pedestrian i of window w, as many for every pedestrian; one
    /// hypothesis a goal, or, with a single goal, one a noise vector. `shares[w][i]`, 0 to 1, is the share of the network's
    /// metric in what shapes the bounded steps of pedestrian i; all of it where there are none.
    ///
    /// # Errors
    /// [`NetworkError::Shape`] when the goals do not fit the windows, or several goals meet several noise vectors.
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
        for batch in batches(windows, goals, (noise, noise_width), rule, shares)? {
            rollouts.extend(batch.windows_of(&self.roll_out(&batch)?));
        }
        Ok(rollouts)
    }
}
