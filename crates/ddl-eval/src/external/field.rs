//! What a field may hold, and how one that holds something else is quoted.

use ddl_data::{COORDINATE_LIMIT, Position};

use super::error::ExternalProblem;
use super::lines::{Wrong, in_field};

/// Longest piece of a file that an error message quotes, in characters.
const QUOTED: usize = 40;
/// Whole numbers are below this in size: exact in an `f64`.
const LIMIT: f64 = 9_007_199_254_740_992.0;

/// The whole number that a number is, if it is one.
pub(super) fn whole(number: f64) -> Option<i64> {
    (number.fract() == 0.0 && number.abs() < LIMIT).then_some(number as i64)
}

/// Refuses a position beyond every map, with which later computations would end in infinities.
pub(super) fn within_bounds(
    position: Position,
    field: impl FnOnce() -> String,
) -> Result<(), Wrong> {
    let far = position.into_iter().find(|c| c.abs() > COORDINATE_LIMIT);
    match far {
        None => Ok(()),
        Some(found) => Err(in_field(field(), ExternalProblem::TooFar { found })),
    }
}

pub(super) fn quoted(text: &str) -> String {
    match text.char_indices().nth(QUOTED) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}
