//! A forecaster that fails on demand.

use ddl::eval::baseline::ConstantVelocity;
use ddl::{Forecast, ForecastError, Forecaster};
use ddl_data::Window;

/// Constant velocity that fails for the windows of which the function is true.
#[derive(Debug)]
pub struct FailingModel<F>(pub F);

impl<F: Fn(&Window) -> bool> Forecaster for FailingModel<F> {
    fn name(&self) -> String {
        "failing".to_owned()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        if (self.0)(window) {
            return Err(ForecastError::model("failing", "on demand"));
        }
        ConstantVelocity::LastStep.forecast(window)
    }
}
