//! The regions that a table of forecasts has.

use ddl_core::{Forecast, Holding};
use std::borrow::Cow;

/// Regions of these probabilities, and what they hold.
#[derive(Debug, Clone, Copy, Default)]
pub struct WantedRegions<'a> {
    /// The probabilities.
    pub levels: &'a [f64],
    /// With each of them.
    pub holding: Holding,
}

impl WantedRegions<'_> {
    /// The forecast with these regions. Its own are of steps; without a table of others it has none of the wanted ones.
    pub(super) fn of<'f>(&self, forecast: &'f Forecast) -> Option<Cow<'f, Forecast>> {
        match self.holding {
            Holding::Step => Some(Cow::Borrowed(forecast)),
            holding => forecast.holding(holding).map(Cow::Owned),
        }
    }
}
