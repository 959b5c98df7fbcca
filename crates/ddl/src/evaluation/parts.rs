//! Test windows in parts, between which an evaluation reports and can stop.

use ddl_core::{Forecast, Window};

const PEDESTRIANS: usize = 128;

/// Consecutive windows of at most 128 pedestrians in all, or one larger window.
pub(crate) fn parts(windows: &[Window]) -> impl Iterator<Item = &[Window]> {
    Window::parts(windows, PEDESTRIANS)
}

pub(crate) fn pedestrians(windows: &[Window]) -> usize {
    windows.iter().map(Window::len).sum()
}

/// The forecasts of the pedestrians that are scored.
pub(crate) fn scored(windows: &[Window], forecasts: Vec<Forecast>) -> impl Iterator<Item = Forecast> {
    forecasts.into_iter().zip(windows).map(|(forecast, window)| forecast.without_bystanders(window))
}
