//! How far away a forecast may lead.

use ddl_data::{COORDINATE_LIMIT, Position};

use super::error::ForeignProblem;
use super::lines::{Wrong, in_field};

/// Refuses a position beyond every map: what is computed with such numbers ends in infinities, far from the line that is to blame.
pub(super) fn within_bounds(
    position: Position,
    field: impl FnOnce() -> String,
) -> Result<(), Wrong> {
    let far = position.into_iter().find(|c| c.abs() > COORDINATE_LIMIT);
    match far {
        None => Ok(()),
        Some(found) => Err(in_field(field(), ForeignProblem::TooFar { found })),
    }
}
