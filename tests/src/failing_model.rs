//! A model whose forecasts fail on demand.

use crate::drawn_model;
use ddl::{Ddl, Forecast, ForecastError, Forecaster, Variant};
use ddl_data::Window;
use std::cell::Cell;

/// A model whose forecasts fail while `fails` is set.
#[derive(Debug)]
pub struct FailingModel {
    model: Ddl,
    /// Whether forecasts fail.
    pub fails: Cell<bool>,
}

impl FailingModel {
    /// A model with random weights.
    #[must_use]
    #[expect(clippy::new_without_default, reason = "a test names what it makes")]
    pub fn new() -> Self {
        Self {
            model: drawn_model::of(Variant::Full),
            fails: Cell::new(false),
        }
    }
}

impl Forecaster for &FailingModel {
    fn name(&self) -> String {
        self.model.name()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        if self.fails.get() {
            return Err(ForecastError::model("test", "on demand"));
        }
        self.model.forecast(window)
    }
}
