//! What was observed of a scene, as windows to forecast from.

use crate::arrays::tracks;
use ddl::ObservedPast;
use ddl::data::{Misfit, OBSERVED, Position};
use numpy::PyReadonlyArray3;
use pyo3::prelude::*;

/// Text about positions of the array that do not fit their tracks.
pub(crate) fn doubt(observed: &ObservedPast) -> Option<String> {
    let place = |misfit: &Misfit| format!("past[{}, {}]", misfit.pedestrian.0, misfit.tick);
    let doubt = Misfit::words(&observed.misfits, place)?;
    Some(doubt + "; check that positions are in metres and steps are 0.4 s")
}

/// The tracks of `(n, 8, 2)` positions.
pub(crate) fn past_tracks(past: &PyReadonlyArray3<'_, f64>) -> PyResult<Vec<Vec<Position>>> {
    tracks("past", past, OBSERVED, true)
}
