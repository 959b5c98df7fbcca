//! The newline-delimited JSON of TrajNet++: scenes and tracks, one object per line.

use std::collections::BTreeMap;

use ddl_core::{FRAME_LIMIT, PedestrianName, Position};
use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer};
use serde_json::Value;
use serde_json::value::RawValue;

use crate::class::is_vehicle;
use crate::clock::TimeUnit;
use crate::format::fault::{FilePlace, FormatError, Problem};
use crate::format::field;
use crate::format::problem::when;
use crate::format::quoted::quoted;
use crate::format::row_filter::{RowFilter, UNTRACKED};
use crate::format::rows::TrackRow;
use crate::scene_name::SceneName;

/// The observed tracks. Forecast tracks, which have a `prediction_number`, are left out. Identical rows count once.
#[expect(clippy::float_cmp, reason = "a repeated track is written with the same digits")]
pub(super) fn parse(text: &str) -> Result<(Vec<TrackRow>, OtherLines), FormatError> {
    let mut seen: BTreeMap<(i64, PedestrianName), (Position, usize)> = BTreeMap::new();
    let mut rows = Vec::new();
    let mut others = OtherLines::default();
    for (index, text) in text.lines().enumerate() {
        let observation = observation(text, index + 1, &mut others);
        let Some(row) = FilePlace::line(index + 1).read(observation)? else { continue };
        let (frame, place, position) = (row.frame, row.place, row.position);
        let key = (frame, row.pedestrian.clone());
        match seen.get(&key) {
            None => {
                seen.insert(key, (position, place.line_number()));
                rows.push(row);
            }
            Some((known, _)) if *known == position => {}
            Some(&(known, first_line)) => {
                // The debug format prints as many digits as distinguish the two.
                let problem = format!(
                    "pedestrian {} is in {} at {position:?}, but on line {first_line} at {known:?}; overlapping scenes \
                     must agree",
                    row.pedestrian,
                    when(frame, row.unit)
                );
                return Err(place.wrong(problem));
            }
        }
    }
    if rows.is_empty() && !text.trim().is_empty() && !text.contains("\"track\"") && !text.contains("\"scene\"") {
        let problem = r#"no line has a track; TrajNet++ writes {"track": {"f": 0, "p": 1, "x": 2.0, "y": 3.0}}"#;
        return Err(FilePlace::line(1).wrong(problem));
    }
    if rows.is_empty() && text.contains("\"prediction_number\"") {
        let problem = "the tracks are forecasts (prediction_number), none is observed; give observed ones, or score \
                       these as forecasts of another program";
        return Err(FilePlace::line(1).wrong(problem));
    }
    Ok((rows, others))
}

/// What lines without an observation say: the frames per second of the scenes, and which are left out.
#[derive(Debug, Default)]
pub(super) struct OtherLines {
    line: usize,
    pub(super) frames_a_second: Option<f64>,
    pub(super) filter: RowFilter,
}

impl OtherLines {
    #[expect(clippy::float_cmp, reason = "equal rates have the same digits")]
    fn take(&mut self, scene: &SceneFields, line: usize) -> Result<(), Problem> {
        let Some(fps) = scene.fps.as_ref().filter(|fps| !fps.is_null()) else { return Ok(()) };
        let rate = fps.as_f64().filter(|fps| fps.is_finite() && *fps > 0.0);
        let found = || quoted(&fps.to_string());
        let rate =
            rate.ok_or_else(|| Problem::value("scene.fps", "a number above 0, the frames in a second", found()))?;
        match self.frames_a_second {
            None => (self.line, self.frames_a_second) = (line, Some(rate)),
            Some(first) if first != rate => {
                let (found, first_line) = (found(), self.line);
                let here = format!("scene.fps is {found}, but {first} on line {first_line}");
                return Err(format!("{here}; a file holds one recording with one frame rate").into());
            }
            Some(_) => {}
        }
        Ok(())
    }
}

/// The parts of a line that are read; other parts are ignored. A repeated part is refused.
#[derive(Deserialize)]
struct TrajnetLine<'a> {
    #[serde(borrow, default)]
    scene: Option<&'a RawValue>,
    #[serde(borrow, default)]
    track: Option<&'a RawValue>,
}

#[derive(Deserialize)]
struct SceneFields {
    #[serde(default)]
    fps: Option<Value>,
}

#[derive(Deserialize)]
struct TrackFields {
    #[serde(default)]
    scene: Option<Value>,
    #[serde(default, deserialize_with = "as_written")]
    f: Option<Value>,
    /// A time in seconds or a date, instead of a frame.
    #[serde(default)]
    t: Option<Value>,
    #[serde(default, deserialize_with = "as_written")]
    p: Option<Value>,
    #[serde(default, deserialize_with = "as_written")]
    x: Option<Value>,
    #[serde(default, deserialize_with = "as_written")]
    y: Option<Value>,
    #[serde(default)]
    prediction_number: Option<IgnoredAny>,
    #[serde(default)]
    class: Option<Value>,
}

impl TrackFields {
    fn left_out(&self) -> Option<String> {
        if self.prediction_number.is_some() {
            return Some("with a prediction_number".to_owned());
        }
        if self.p.as_ref().and_then(Value::as_i64) == Some(-1) {
            return Some(UNTRACKED.to_owned());
        }
        let class = self.class.as_ref()?.as_str().filter(|class| is_vehicle(class))?;
        Some(format!("of class {}", quoted(class)))
    }
}

fn as_written<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Value>, D::Error> {
    Value::deserialize(deserializer).map(Some)
}

/// The observation of a line, if it holds one. What another line says is kept.
pub(super) fn observation(text: &str, line: usize, others: &mut OtherLines) -> Result<Option<TrackRow>, Problem> {
    if text.trim().is_empty() {
        return Ok(None);
    }
    let wrong = |error: serde_json::Error| not_one_object(&error.to_string());
    if !text.trim_start().starts_with('{') {
        let other: Value = serde_json::from_str(text).map_err(wrong)?;
        return Err(not_one_object(&format!("found {}", quoted(&other.to_string()))));
    }
    let parts: TrajnetLine<'_> = serde_json::from_str(text).map_err(wrong)?;
    // A scene that is not an object shows that the file is of another kind.
    let scene = fields::<SceneFields>(parts.scene, "scene")?;
    if let Some(scene) = &scene {
        others.take(scene, line)?;
    }
    let Some(track) = fields::<TrackFields>(parts.track, "track")? else {
        if scene.is_none() {
            others.filter.leave_out("without a track or scene".to_owned());
        }
        return Ok(None);
    };
    if let Some(why) = track.left_out() {
        others.filter.leave_out(why);
        return Ok(None);
    }
    let unit = match (&track.t, &track.f) {
        (Some(Value::String(_)), None) => Some(TimeUnit::Dates),
        (Some(_), None) => Some(TimeUnit::Seconds),
        (Some(_), Some(_)) => return Err("track.f and track.t: give a frame or a time".into()),
        (None, _) => None,
    };
    let when = match track.t {
        Some(Value::String(date)) => date,
        Some(time) => time.to_string(),
        None => written(track.f, "track.f")?,
    };
    let frame = field::frame(&when, "track.f", unit)?;
    let pedestrian = pedestrian(track.p)?;
    let x = field::coordinate(&written(track.x, "track.x")?, "track.x", 1.0)?;
    let y = field::coordinate(&written(track.y, "track.y")?, "track.y", 1.0)?;
    let scene = match track.scene {
        None => None,
        Some(Value::String(name)) => Some(SceneName::new(&name).map_err(|error| error.to_string())?),
        Some(other) => {
            return Err(Problem::value("track.scene", "a text, such as \"hall\"", quoted(&other.to_string())));
        }
    };
    Ok(Some(TrackRow { scene, frame, unit, pedestrian, position: [x, y], place: FilePlace::line(line) }))
}

/// A value as in the file: the digits of a number, or a text with its quotes, which is then refused as a number.
fn written(value: Option<Value>, name: &str) -> Result<String, Problem> {
    Ok(value.ok_or_else(|| format!("{name} is missing"))?.to_string())
}

fn pedestrian(value: Option<Value>) -> Result<PedestrianName, Problem> {
    let is_large = |number: f64| number.abs() >= FRAME_LIMIT as f64;
    match value {
        // A quoted pedestrian is a word, even if it holds only digits.
        Some(Value::String(word)) if !word.trim().is_empty() => field::word(word.trim(), "track.p"),
        Some(Value::Number(number)) if number.is_f64() && number.as_f64().is_some_and(is_large) => {
            Err(format!("track.p {number} has lost digits, as a number of JSON; write it as a text").into())
        }
        Some(Value::Number(number)) => field::pedestrian(&number.to_string(), "track.p"),
        other => Ok(PedestrianName::Number(field::integer(&written(other, "track.p")?, "track.p")?)),
    }
}

/// The fields of a part; `None` where it is missing or null.
fn fields<'a, T: Deserialize<'a>>(part: Option<&'a RawValue>, name: &'static str) -> Result<Option<T>, Problem> {
    let Some(text) = part.map(RawValue::get) else { return Ok(None) };
    if !text.starts_with('{') {
        return Err(Problem::value(name, "a JSON object", quoted(text)));
    }
    serde_json::from_str(text).map(Some).map_err(|error| not_one_object(&format!("{name}: {error}")))
}

fn not_one_object(detail: &str) -> Problem {
    format!("the line must be one JSON object (which has no NaN and no Infinity): {detail}").into()
}
