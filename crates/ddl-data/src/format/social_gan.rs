//! The `social-gan` text: one observation a line, separated by tabs or blanks.

use super::rows::{self, FIELDS, Row};
use super::{Place, field};
use crate::error::{FormatError, FormatProblem};

pub(super) fn parse(text: &str, origin: &str) -> Result<Vec<Row>, FormatError> {
    rows::of_lines(text, origin, row)
}

pub(super) fn row(text: &str, line: usize, origin: &str) -> Result<Row, FormatError> {
    let here = Place { line, field: None };
    let fields: Vec<&str> = text.split_ascii_whitespace().collect();
    let &[frame, pedestrian, x, y] = fields.as_slice() else {
        let problem = FormatProblem::FieldCount {
            expected: 4,
            found: fields.len(),
            names: FIELDS,
        };
        return Err(here.wrong(origin, problem));
    };
    let at = |field: usize| {
        move |p| {
            Place {
                line,
                field: Some(field),
            }
            .wrong(origin, p)
        }
    };
    let frame = field::integer(frame, "frame").map_err(at(1))?;
    let who = field::pedestrian(pedestrian, "pedestrian").map_err(at(2))?;
    let x = field::coordinate(x, "x").map_err(at(3))?;
    let y = field::coordinate(y, "y").map_err(at(4))?;
    Ok(Row {
        frame,
        who,
        position: [x, y],
        place: here,
    })
}
