//! The newline-delimited JSON of TrajNet++: scenes and tracks, one object a line.

use std::collections::BTreeMap;

use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer};
use serde_json::Value;

use super::json_section::Section;
use super::rows::Row;
use super::{Place, field};
use crate::error::{FormatError, FormatProblem};
use crate::{PedestrianId, Position};

/// The tracks that were observed: those of forecasts, which name a `prediction_number`, are left out.
///
/// Scenes say which part of the recording is to be forecast and add no observation. Where they overlap,
/// files may repeat a track; rows that agree count once.
#[expect(
    clippy::float_cmp,
    reason = "a repeated track is written with the same digits"
)]
pub(super) fn parse(text: &str, origin: &str) -> Result<Vec<Row>, FormatError> {
    let mut seen: BTreeMap<(i64, i64), (Position, usize)> = BTreeMap::new();
    let mut rows = Vec::new();
    for (index, text) in text.lines().enumerate() {
        let place = Place {
            line: index + 1,
            field: None,
        };
        let found = observation(text).map_err(|problem| place.wrong(origin, problem))?;
        let Some((frame, pedestrian, position)) = found else {
            continue;
        };
        match seen.get(&(frame, pedestrian)) {
            None => {
                seen.insert((frame, pedestrian), (position, place.line));
                rows.push(Row::new(frame, pedestrian, position, place));
            }
            Some((known, _)) if *known == position => {}
            Some(&(known, first_line)) => {
                let problem = FormatProblem::Disagreement {
                    pedestrian: PedestrianId(pedestrian),
                    frame,
                    first_line,
                    // shortest digits that tell the two apart
                    first: format!("{known:?}"),
                    found: format!("{position:?}"),
                };
                return Err(place.wrong(origin, problem));
            }
        }
    }
    Ok(rows)
}

/// The parts of a line that are read; others may stand beside them. A part that is there twice is refused.
#[derive(Deserialize)]
struct Line {
    #[serde(default)]
    scene: Option<Section<IgnoredAny>>,
    #[serde(default)]
    track: Option<Section<Track>>,
}

/// The fields of a track, as they are written.
#[derive(Deserialize)]
struct Track {
    #[serde(default, deserialize_with = "as_written")]
    f: Option<Value>,
    #[serde(default, deserialize_with = "as_written")]
    p: Option<Value>,
    #[serde(default, deserialize_with = "as_written")]
    x: Option<Value>,
    #[serde(default, deserialize_with = "as_written")]
    y: Option<Value>,
    #[serde(default)]
    prediction_number: Option<IgnoredAny>,
}

/// A field that is there, be it null.
fn as_written<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Value>, D::Error> {
    Value::deserialize(deserializer).map(Some)
}

/// Frame, pedestrian and position of a line, if it holds an observation.
pub(super) fn observation(text: &str) -> Result<Option<(i64, i64, Position)>, FormatProblem> {
    if text.trim().is_empty() {
        return Ok(None);
    }
    let not_one = |detail: String| FormatProblem::Json { detail };
    let line: Section<Line> =
        serde_json::from_str(text).map_err(|error| not_one(error.to_string()))?;
    let line = match line {
        Section::Fields(line) => line,
        Section::Other(found) => return Err(not_one(format!("found {found}"))),
    };
    // A scene is not used, but one that is no object shows that the file is not what it seems.
    fields(line.scene, "scene")?;
    let Some(track) = fields(line.track, "track")? else {
        return Ok(None);
    };
    if track.prediction_number.is_some() {
        return Ok(None);
    }
    let text = |value: Option<Value>, name: &'static str| match value {
        None => Err(FormatProblem::MissingField { name }),
        // as it is written: a number in its digits, text in quotes, which is no number
        Some(value) => Ok(value.to_string()),
    };
    let frame = field::integer(&text(track.f, "track.f")?, "track.f")?;
    let pedestrian = field::integer(&text(track.p, "track.p")?, "track.p")?;
    let x = field::coordinate(&text(track.x, "track.x")?, "track.x")?;
    let y = field::coordinate(&text(track.y, "track.y")?, "track.y")?;
    Ok(Some((frame, pedestrian, [x, y])))
}

/// The fields of a part; none where there is none, or null.
fn fields<T>(section: Option<Section<T>>, name: &'static str) -> Result<Option<T>, FormatProblem> {
    match section {
        None => Ok(None),
        Some(Section::Fields(fields)) => Ok(Some(fields)),
        Some(Section::Other(found)) => Err(FormatProblem::NotObject { name, found }),
    }
}
