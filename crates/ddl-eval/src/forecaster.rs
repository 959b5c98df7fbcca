//! What every model and every baseline is to the evaluation.

use std::sync::Arc;

use ddl_data::Window;

use crate::{Forecast, error::ForecastError};

/// Something that forecasts the people of a window: a baseline, the DDL model or any other.
///
/// # Contract
/// A forecaster reads [`Window::observed`] alone, which `leak::find` checks. One that also reads the future where it is
/// shown (protocol `published`) must not need it, or must fail with [`ForecastError::FutureMissing`].
pub trait Forecaster {
    /// The name printed in tables, the same for every window.
    fn name(&self) -> String;

    /// Forecasts one window: the pedestrians of the forecast are those of the window, in its order.
    ///
    /// # Errors
    /// The model failed, or needs a future that is not there.
    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError>;

    /// Forecasts many windows; models that work in batches override it.
    ///
    /// # Errors
    /// As [`Forecaster::forecast`]; the first failure ends the work.
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
