//! The interface of models and baselines.

use std::sync::Arc;

use crate::error::ForecastError;
use crate::forecast::Forecast;
use crate::window::Window;

/// A forecaster of the pedestrians of a window: a baseline, the DDL model or any other.
///
/// # Contract
/// A forecaster reads only [`Window::observed`], which `ddl_eval::leak::find` checks. If it also reads a visible future
/// (protocol `published`), it must work without it or fail with [`ForecastError::FutureMissing`].
pub trait Forecaster {
    /// The name printed in tables, the same for every window.
    fn name(&self) -> String;

    /// Forecasts the pedestrians of one window, in the order of [`Window::pedestrians`].
    ///
    /// # Errors
    /// The model failed, or it needs a future and the window has none.
    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError>;

    /// Forecasts many windows; models that work in batches override it.
    ///
    /// # Errors
    /// As [`Forecaster::forecast`], at the first failure.
    fn forecast_all(&self, windows: &[Window]) -> Result<Vec<Forecast>, ForecastError> {
        windows.iter().map(|window| self.forecast(window)).collect()
    }
}

macro_rules! forward {
    ($($pointer:ty),*) => {$(
        impl<F: Forecaster + ?Sized> Forecaster for $pointer {
            fn name(&self) -> String {
                (**self).name()
            }
            fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
                (**self).forecast(window)
            }
            fn forecast_all(&self, windows: &[Window]) -> Result<Vec<Forecast>, ForecastError> {
                (**self).forecast_all(windows)
            }
        }
    )*};
}
forward!(&F, Box<F>, Arc<F>);
