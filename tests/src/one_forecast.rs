//! The one forecast of a model, as a robot takes it, and as `single` measures it.

use ddl::data::Window;
use ddl::eval::ForecastError;
use ddl::{Ddl, Forecast, Forecaster};

/// A model asked for one forecast alone.
#[derive(Debug)]
pub struct One<'a>(pub &'a Ddl);

impl Forecaster for One<'_> {
    fn name(&self) -> String {
        "DDL, one forecast".to_owned()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        // one window in, one forecast out
        let mut forecasts = self.0.forecast_one(std::slice::from_ref(window))?;
        Ok(forecasts.remove(0))
    }
}
