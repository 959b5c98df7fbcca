//! Lines of files of forecasts, and checks of their fields.

use std::io::BufRead;

use ddl_core::{COORDINATE_LIMIT, FRAME_LIMIT, HORIZON, Position};
use ddl_data::{Fault, TextLines};

/// Longest line, bytes: twenty times the length of 20 hypotheses with certificates.
const LIMIT: usize = 4 << 20;

pub(super) fn lines_of<R: BufRead>(reader: R, origin: &str) -> TextLines<R> {
    TextLines::new(reader, origin, LIMIT, "write one line for each pedestrian")
}

pub(super) fn missing(field: impl Into<String>) -> Fault {
    Fault::named(field, "is missing")
}

pub(super) fn not_finite(found: &str) -> String {
    format!("must be a finite number, found {found}; a model that diverged must be reported as such, not scored")
}

pub(super) fn wrong_length(found: usize) -> String {
    format!("{found} positions; a forecast has {HORIZON}, 0.4 s apart, after the last observed frame")
}

pub(super) fn whole_number(number: f64) -> Option<i64> {
    (number.fract() == 0.0 && number.abs() < FRAME_LIMIT as f64).then_some(number as i64)
}

/// Refuses a position so far away that later computations would overflow.
pub(super) fn within_bounds(position: Position, field: impl FnOnce() -> String) -> Result<(), Fault> {
    position.into_iter().find(|c| c.abs() > COORDINATE_LIMIT).map_or(Ok(()), |found| {
        Err(Fault::named(field(), format!("must lie within {COORDINATE_LIMIT} m of the origin, found {found}")))
    })
}
