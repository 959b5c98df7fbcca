//! Bitwise comparison of forecasts, because `==` on floats does not distinguish 0.0 and -0.0.

use ddl_core::Forecast;

pub use ddl_eval::leak::bits as of;

/// The bits of many forecasts, one entry per window.
pub fn of_all(forecasts: &[Forecast]) -> Vec<Vec<u64>> {
    forecasts.iter().map(of).collect()
}
