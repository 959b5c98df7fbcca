//! Text with one observation per line, its columns separated by tabs or blanks: `social-gan`, and the `obsmat` of the
//! ETH recordings.

use crate::clock::TimeUnit;
use crate::error::FormatError;
use crate::format::field::{self, PedestrianField};
use crate::format::place::FilePlace;
use crate::format::problem::field_count;
use crate::format::rows::{FIELDS, TrackRow};

const OBSMAT: &str = "frame, pedestrian, x, z, y, v_x, v_z, v_y";

/// The rows of a text; `row` parses one line, given its number and the name of its origin.
pub(super) fn parse(
    text: &str,
    origin: &str,
    row: fn(&str, usize, &str, Option<TimeUnit>) -> Result<TrackRow, FormatError>,
) -> Result<Vec<TrackRow>, FormatError> {
    // Blank lines are an error between observations, but allowed after the last one.
    let lines = || text.trim_end().lines();
    let mut times = lines().filter_map(|line| line.split_ascii_whitespace().next());
    let unit = times.any(field::has_fraction).then_some(TimeUnit::Seconds);
    let lines = lines().enumerate();
    lines.map(|(index, line)| row(line, index + 1, origin, unit)).collect()
}

fn fields<'a, const COUNT: usize>(
    text: &'a str,
    line: usize,
    origin: &str,
    names: &str,
) -> Result<[&'a str; COUNT], FormatError> {
    let fields: Vec<&str> = text.split_ascii_whitespace().collect();
    let found = fields.len();
    let fields = fields.try_into();
    fields.map_err(|_| FilePlace::line(line).wrong(origin, field_count(COUNT, found, names)))
}

pub(super) fn social_gan(
    text: &str,
    line: usize,
    origin: &str,
    unit: Option<TimeUnit>,
) -> Result<TrackRow, FormatError> {
    let [frame, pedestrian, x, y] = fields(text, line, origin, FIELDS)?;
    TrackRow::of(line, origin, unit, [(1, frame), (2, pedestrian), (3, x), (4, y)])
}

pub(super) fn obsmat(text: &str, line: usize, origin: &str, unit: Option<TimeUnit>) -> Result<TrackRow, FormatError> {
    let [frame, pedestrian, x, z, y, v_x, v_z, v_y] = fields(text, line, origin, OBSMAT)?;
    let place = |field: usize| FilePlace::field(line, field);
    let row = TrackRow::of(line, origin, unit, [(1, frame), (2, pedestrian), (3, x), (5, y)])?;
    // Pedestrians are floats in this format, never words.
    let number = place(2).read(origin, field::integer(pedestrian, "pedestrian"))?;
    // Height and velocities are not used. Checking that they are numbers confirms the order of the columns.
    for (field, name, text) in [(4, "z", z), (6, "v_x", v_x), (7, "v_z", v_z), (8, "v_y", v_y)] {
        place(field).read(origin, field::number(text, name))?;
    }
    Ok(TrackRow {
        pedestrian: PedestrianField::Number(number, None),
        ..row
    })
}
