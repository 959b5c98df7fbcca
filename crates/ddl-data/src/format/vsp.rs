//! The `.vsp` annotations of UCY: a spline for each pedestrian, with control points in pixels.

use ddl_core::{Position, between};

use crate::format::choice::ColumnChoice;
use crate::format::fault::{FilePlace, FormatError};
use crate::format::field;
use crate::format::rows::TrackRow;
use crate::format::text::TextFile;
use crate::format::track_columns::note_on_pixels;

/// Frames a second of the films.
const RATE: f64 = 25.0;
/// Frames between two positions: 0.4 s.
const STEP: i64 = 10;
/// Between control points that are more frames apart, 20 s, nothing is known.
const LONGEST: i64 = 500;
/// Far more than the films have.
const MOST_ROWS: usize = 5_000_000;
const NOTE: &str = "read as splines of UCY, 25 frames a second: positions every 10 frames, on straight lines between \
    control points, so that a forecast knows where the next one lies";

/// Whether a first line is that of such a file.
pub(super) fn is_first(line: &str) -> bool {
    line.contains("the number of splines") || line.contains("Num of control points")
}

struct ControlPoint {
    frame: i64,
    position: Position,
    line: usize,
}

pub(super) fn parse(text: &str, choice: &ColumnChoice) -> Result<TextFile, FormatError> {
    let mut splines: Vec<(usize, usize, Vec<ControlPoint>)> = Vec::new();
    let mut promised = None;
    for (line, text) in (1..).zip(text.lines()) {
        let (values, said) = text.split_once(" - ").unwrap_or((text, ""));
        let place = FilePlace::line(line);
        let values: Vec<&str> = values.split_ascii_whitespace().collect();
        if values.is_empty() {
            continue;
        }
        if said.contains("number of splines") {
            promised = Some(place.read(field::integer(values[0], "the number of splines"))?);
            continue;
        }
        if said.contains("control points") {
            let count = field::integer(values[0], "the number of control points");
            splines.push((line, place.read(count)?.max(0) as usize, Vec::new()));
            continue;
        }
        let (Some((.., points)), [x, y, frame, _]) = (splines.last_mut(), &values[..]) else {
            return Err(place.wrong("expected a control point: x, y, frame and the direction of gaze"));
        };
        let number = |text: &str, name: &str| field::coordinate(text, name, 1.0);
        let position = [place.read(number(x, "x"))?, place.read(number(y, "y"))?];
        let frame = place.read(field::integer(frame, "frame"))?;
        points.push(ControlPoint { frame, position, line });
    }
    if let Some(promised) = promised.filter(|promised| *promised != splines.len() as i64) {
        let problem = format!("the file has {} of its {promised} splines; is it cut off?", splines.len());
        return Err(FilePlace::line(1).wrong(problem));
    }
    let (rows, lost) = rows_of(&splines)?;
    let left_out = (lost > 0)
        .then(|| format!("left out: {lost} splines of one control point, or parts between two more than 20 s apart"));
    let pixels = (!choice.is_mapped).then(note_on_pixels);
    let notes = std::iter::once(NOTE.to_owned()).chain(pixels).chain(left_out);
    Ok(TextFile::without_columns(rows, notes, Some(RATE)))
}

/// The positions of all splines, and the number of parts that are left out.
fn rows_of(splines: &[(usize, usize, Vec<ControlPoint>)]) -> Result<(Vec<TrackRow>, usize), FormatError> {
    let (mut rows, mut lost) = (Vec::new(), 0);
    for (id, (line, count, points)) in (1..).zip(splines) {
        if points.len() != *count {
            let found = points.len();
            let problem = format!("the spline has {found} of its {count} control points; is the file cut off?");
            return Err(FilePlace::line(*line).wrong(problem));
        }
        let apart = |pair: &&[ControlPoint; 2]| pair[1].frame - pair[0].frame > LONGEST;
        lost += points.array_windows().filter(apart).count() + usize::from(points.len() < 2);
        along(id, points, &mut rows)?;
    }
    Ok((rows, lost))
}

/// Adds the positions of a spline at the frames that are multiples of [`STEP`].
fn along(id: i64, points: &[ControlPoint], rows: &mut Vec<TrackRow>) -> Result<(), FormatError> {
    let begin = rows.len();
    for [before, after] in points.array_windows() {
        let apart = after.frame - before.frame;
        let place = FilePlace::line(after.line);
        if apart < 0 {
            return Err(place.wrong("the frames of a spline must increase"));
        }
        if apart > LONGEST {
            continue;
        }
        let first = before.frame + (-before.frame).rem_euclid(STEP);
        for frame in (first..=after.frame).step_by(STEP as usize) {
            if rows[begin..].last().is_some_and(|row| row.frame >= frame) {
                continue;
            }
            let share = (frame - before.frame) as f64 / apart.max(1) as f64;
            rows.push(TrackRow::numbered(frame, id, between(before.position, after.position, share), place));
        }
        if rows.len() > MOST_ROWS {
            return Err(place.wrong(format!("the splines have more than {MOST_ROWS} positions; are the frames right?")));
        }
    }
    Ok(())
}
