//! The `social-gan` text: one observation a line, separated by tabs or blanks.

use super::field;
use super::place::Place;
use super::rows::{self, FIELDS, Row};
use crate::error::FormatError;

pub(super) fn parse(text: &str, origin: &str) -> Result<Vec<Row>, FormatError> {
    rows::of_lines(text, origin, row)
}

pub(super) fn row(text: &str, line: usize, origin: &str) -> Result<Row, FormatError> {
    let place = Place::line(line);
    let [frame, pedestrian, x, y] = rows::fields(text, place, origin, FIELDS)?;
    let at = |field: usize| Place::field(line, field);
    Ok(Row {
        frame: at(1).read(origin, field::integer(frame, "frame"))?,
        who: at(2).read(origin, field::pedestrian(pedestrian, "pedestrian"))?,
        position: [
            at(3).read(origin, field::coordinate(x, "x"))?,
            at(4).read(origin, field::coordinate(y, "y"))?,
        ],
        place,
    })
}
