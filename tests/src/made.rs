//! A forecaster made of a function.

use ddl::data::Window;
use ddl::{Forecast, ForecastError, Forecaster};

/// Forecasts by a function of windows.
#[derive(Debug)]
pub struct Made<F>(pub F);

impl<F: Fn(&[Window]) -> Result<Vec<Forecast>, ForecastError>> Forecaster for Made<F> {
    fn name(&self) -> String {
        "made".to_owned()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        Ok((self.0)(std::slice::from_ref(window))?.remove(0))
    }

    fn forecast_all(&self, windows: &[Window]) -> Result<Vec<Forecast>, ForecastError> {
        (self.0)(windows)
    }
}
