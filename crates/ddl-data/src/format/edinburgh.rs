//! The tracks of the Edinburgh forum: a line `TRACK.R12=[[x y frame];[x y frame];...];` for each pedestrian.

use ddl_core::Setting;

use crate::format::choice::ColumnChoice;
use crate::format::fault::{FilePlace, FormatError};
use crate::format::field;
use crate::format::quoted::quoted;
use crate::format::rows::TrackRow;
use crate::format::text::TextFile;

const TRACK: &str = "TRACK.R";
const PROPERTIES: &str = "Properties.R";
/// Frames a second of the films, as their makers say.
const RATE: f64 = 9.0;
/// Pixels in a metre of the floor: 24.7 mm each.
const PER_METRE: f64 = 1.0 / 0.0247;
const NOTE: &str = "read as tracks of the Edinburgh forum, 9 frames a second";

/// Whether a first line is that of such a file.
pub(super) fn is_first(line: &str) -> bool {
    let line = line.trim_start();
    line.starts_with(TRACK) || line.starts_with(PROPERTIES)
}

pub(super) fn parse(text: &str, choice: &ColumnChoice) -> Result<TextFile, FormatError> {
    let per_metre = if choice.is_mapped { 1.0 } else { PER_METRE };
    let (mut rows, mut repeated) = (Vec::new(), 0);
    for (line, text) in (1..).zip(text.lines()) {
        let text = text.trim();
        if text.is_empty() || text.starts_with('%') || text.starts_with(PROPERTIES) {
            continue;
        }
        let place = FilePlace::line(line);
        let track = text.strip_prefix(TRACK).and_then(|text| text.split_once('='));
        let Some((pedestrian, points)) = track else {
            return Err(place.wrong("expected a track such as TRACK.R1=[[269 466 12];[270 465 13]];"));
        };
        if !points.trim_end_matches(';').ends_with("]]") {
            return Err(place.wrong("the track does not end with ]]; is the file cut off?"));
        }
        let pedestrian = place.read(field::integer(pedestrian, "the number of the track"))?;
        let mut last_frame = None;
        for point in points.split(';').map(|point| point.replace(['[', ']'], " ")) {
            let values: Vec<&str> = point.split_ascii_whitespace().collect();
            let [x, y, frame] = values[..] else {
                if values.is_empty() {
                    continue;
                }
                return Err(place.wrong(format!("expected x, y and frame, found {:?}", quoted(&point))));
            };
            let frame = place.read(field::integer(frame, "frame"))?;
            let number = |text: &str, name: &str| field::coordinate(text, name, per_metre);
            let position = [place.read(number(x, "x"))?, place.read(number(y, "y"))?];
            if last_frame.replace(frame) == Some(frame) {
                repeated += 1;
                continue;
            }
            rows.push(TrackRow::numbered(frame, pedestrian, position, place));
        }
    }
    let scale = (!choice.is_mapped).then(|| format!("a pixel is taken as 24.7 mm (or give {})", Setting::Homography));
    let left_out = (repeated > 0).then(|| format!("rows left out: {repeated} at the same frame as the one before"));
    let notes = std::iter::once(NOTE.to_owned()).chain(scale).chain(left_out);
    Ok(TextFile::without_columns(rows, notes, Some(RATE)))
}
