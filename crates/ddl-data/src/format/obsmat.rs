//! The `obsmat` text of the ETH recordings: eight columns of floats, one observation a line.

use super::field::Who;
use super::rows::{self, Row};
use super::{Place, field};
use crate::error::{FormatError, FormatProblem};

const COLUMNS: [&str; 8] = ["frame", "pedestrian", "x", "z", "y", "v_x", "v_z", "v_y"];
const NAMES: &str = "frame, pedestrian, x, z, y, v_x, v_z, v_y";

pub(super) fn parse(text: &str, origin: &str) -> Result<Vec<Row>, FormatError> {
    rows::of_lines(text, origin, row)
}

pub(super) fn row(text: &str, line: usize, origin: &str) -> Result<Row, FormatError> {
    let here = Place { line, field: None };
    let fields: Vec<&str> = text.split_ascii_whitespace().collect();
    let &[frame, pedestrian, x, z, y, v_x, v_z, v_y] = fields.as_slice() else {
        let problem = FormatProblem::FieldCount {
            expected: COLUMNS.len(),
            found: fields.len(),
            names: NAMES,
        };
        return Err(here.wrong(origin, problem));
    };
    let at = |column: usize| {
        move |problem| {
            let field = Some(column + 1);
            Place { line, field }.wrong(origin, problem)
        }
    };
    let frame = field::integer(frame, COLUMNS[0]).map_err(at(0))?;
    let pedestrian = field::integer(pedestrian, COLUMNS[1]).map_err(at(1))?;
    let position = [
        field::coordinate(x, COLUMNS[2]).map_err(at(2))?,
        field::coordinate(y, COLUMNS[4]).map_err(at(4))?,
    ];
    // Height and velocities are not used; that they are numbers shows that the columns are these.
    for (column, text) in [(3, z), (5, v_x), (6, v_z), (7, v_y)] {
        field::number(text, COLUMNS[column]).map_err(at(column))?;
    }
    Ok(Row {
        frame,
        who: Who::Number(pedestrian, None),
        position,
        place: here,
    })
}
