//! The `star` CSV format: four long parallel lines.

use crate::format::fault::{FilePlace, FormatError};
use crate::format::field;
use crate::format::problem::EMPTY;
use crate::format::rows::TrackRow;

const LINES: usize = 4;
const NAMES: &str = "frame, pedestrian, y, x";

pub(super) fn parse(text: &str) -> Result<Vec<TrackRow>, FormatError> {
    let text = text.trim_end();
    if text.is_empty() {
        return Err(FilePlace::line(1).wrong(EMPTY));
    }
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    if lines.len() > LINES {
        let problem = format!("unexpected line: the format has exactly {LINES} lines");
        return Err(FilePlace::line(LINES + 1).wrong(problem));
    }
    let [frames, pedestrians, ys, xs] = lines.as_slice() else {
        let problem = format!("line missing: the format has exactly {LINES} lines ({NAMES}), the file ends here");
        return Err(FilePlace::line(lines.len() + 1).wrong(problem));
    };
    let expected = frames.len();
    for (index, line) in lines.iter().enumerate() {
        let found = line.len();
        if found != expected {
            let problem =
                format!("{found} fields, but line 1 has {expected}; all lines must have the same number of fields");
            return Err(FilePlace::line(index + 1).wrong(problem));
        }
    }
    let row = |index: usize| {
        let place = |line: usize| FilePlace::field(line, index + 1);
        let pedestrian = field::integer(pedestrians[index], "pedestrian");
        let frame = place(1).read(field::integer(frames[index], "frame"))?;
        let pedestrian = place(2).read(pedestrian)?;
        // The third line is y and the fourth x, as in the published code of STAR and DDL.
        let y = place(3).read(field::coordinate(ys[index], "y", 1.0))?;
        let x = place(4).read(field::coordinate(xs[index], "x", 1.0))?;
        Ok(TrackRow::numbered(frame, pedestrian, [x, y], place(2)))
    };
    (0..expected).map(row).collect()
}
