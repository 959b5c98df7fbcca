//! The single forecast of a model, as used by robots and by the protocol `single`.

use ddl::data::Window;
use ddl::{Ddl, Forecast, ForecastError, Forecaster};

/// A model restricted to its single forecast.
#[derive(Debug)]
pub struct One<'a>(pub &'a Ddl);

impl Forecaster for One<'_> {
    fn name(&self) -> String {
        "DDL, one forecast".to_owned()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        // One window in, one forecast out.
        let mut forecasts = self.0.forecast_central(std::slice::from_ref(window))?;
        Ok(forecasts.remove(0))
    }
}
