//! The `star` csv: four long lines that run in parallel.

use super::field::Who;
use super::rows::Row;
use super::{Place, field};
use crate::error::{FormatError, FormatProblem};

const LINES: usize = 4;
const NAMES: &str = "frame, pedestrian, y, x";

pub(super) fn parse(text: &str, origin: &str) -> Result<Vec<Row>, FormatError> {
    let at = |line: usize, field: Option<usize>| Place { line, field };
    let text = text.trim_end();
    if text.is_empty() {
        return Err(at(1, None).wrong(origin, FormatProblem::Empty));
    }
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    if lines.len() > LINES {
        let problem = FormatProblem::ExtraLine { expected: LINES };
        return Err(at(LINES + 1, None).wrong(origin, problem));
    }
    let [frames, pedestrians, ys, xs] = lines.as_slice() else {
        let problem = FormatProblem::MissingLine {
            expected: LINES,
            names: NAMES,
        };
        return Err(at(lines.len() + 1, None).wrong(origin, problem));
    };
    let expected = frames.len();
    for (index, line) in lines.iter().enumerate() {
        let found = line.len();
        if found != expected {
            let problem = FormatProblem::UnequalLines { expected, found };
            return Err(at(index + 1, None).wrong(origin, problem));
        }
    }
    let mut rows = Vec::with_capacity(expected);
    for index in 0..expected {
        let place = |line: usize| at(line, Some(index + 1));
        let whole = |line: usize, text: &str, name| {
            field::integer(text, name).map_err(|p| place(line).wrong(origin, p))
        };
        let metres = |line: usize, text: &str, name| {
            field::coordinate(text, name).map_err(|p| place(line).wrong(origin, p))
        };
        let frame = whole(1, frames[index], "frame")?;
        let pedestrian = whole(2, pedestrians[index], "pedestrian")?;
        // The third line is y and the fourth x: that is how STAR and DDL read these files.
        let y = metres(3, ys[index], "y")?;
        let x = metres(4, xs[index], "x")?;
        rows.push(Row {
            frame,
            who: Who::Number(pedestrian, None),
            position: [x, y],
            place: place(2),
        });
    }
    Ok(rows)
}
