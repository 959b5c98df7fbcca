//! The newline-delimited JSON of TrajNet++: scenes and tracks, one object a line.

use std::collections::BTreeMap;

use serde_json::{Map, Value};

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

/// Frame, pedestrian and position of a line, if it holds an observation.
pub(super) fn observation(text: &str) -> Result<Option<(i64, i64, Position)>, FormatProblem> {
    if text.trim().is_empty() {
        return Ok(None);
    }
    let line: Map<String, Value> =
        serde_json::from_str(text).map_err(|error| FormatProblem::Json {
            detail: error.to_string(),
        })?;
    // A scene is not used, but one that is no object shows that the file is not what it seems.
    section(&line, "scene")?;
    let Some(track) = section(&line, "track")? else {
        return Ok(None);
    };
    if track.get("prediction_number").is_some_and(|n| !n.is_null()) {
        return Ok(None);
    }
    let text = |key: &str, name: &'static str| match track.get(key) {
        None => Err(FormatProblem::MissingField { name }),
        // as it is written: a number in its digits, text in quotes, which is no number
        Some(value) => Ok(value.to_string()),
    };
    let frame = field::integer(&text("f", "track.f")?, "track.f")?;
    let pedestrian = field::integer(&text("p", "track.p")?, "track.p")?;
    let x = field::coordinate(&text("x", "track.x")?, "track.x")?;
    let y = field::coordinate(&text("y", "track.y")?, "track.y")?;
    Ok(Some((frame, pedestrian, [x, y])))
}

/// The object of that name; `None` where there is none, or null.
fn section<'a>(
    line: &'a Map<String, Value>,
    name: &'static str,
) -> Result<Option<&'a Map<String, Value>>, FormatProblem> {
    match line.get(name) {
        None | Some(Value::Null) => Ok(None),
        Some(Value::Object(section)) => Ok(Some(section)),
        Some(other) => Err(FormatProblem::NotObject {
            name,
            found: field::quoted(&other.to_string()),
        }),
    }
}
