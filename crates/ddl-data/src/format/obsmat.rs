//! The `obsmat` text of the ETH recordings: eight columns of floats, one observation a line.

use super::field::{self, Who};
use super::place::Place;
use super::rows::{self, Row};
use crate::error::FormatError;

const NAMES: &str = "frame, pedestrian, x, z, y, v_x, v_z, v_y";

pub(super) fn parse(text: &str, origin: &str) -> Result<Vec<Row>, FormatError> {
    rows::of_lines(text, origin, row)
}

pub(super) fn row(text: &str, line: usize, origin: &str) -> Result<Row, FormatError> {
    let place = Place::line(line);
    let fields = rows::fields(text, place, origin, NAMES)?;
    let [frame, pedestrian, x, z, y, v_x, v_z, v_y] = fields;
    let at = |field: usize| Place::field(line, field);
    let row = Row {
        frame: at(1).read(origin, field::integer(frame, "frame"))?,
        who: Who::Number(
            at(2).read(origin, field::integer(pedestrian, "pedestrian"))?,
            None,
        ),
        position: [
            at(3).read(origin, field::coordinate(x, "x"))?,
            at(5).read(origin, field::coordinate(y, "y"))?,
        ],
        place,
    };
    // Height and velocities are not used; that they are numbers shows that the columns are these.
    for (field, name, text) in [
        (4, "z", z),
        (6, "v_x", v_x),
        (7, "v_z", v_z),
        (8, "v_y", v_y),
    ] {
        at(field).read(origin, field::number(text, name))?;
    }
    Ok(row)
}
