//! A line of TrajNet++ ndjson.

use ddl_data::PedestrianName;
use serde::Deserialize;
use serde_json::{Map, Value};

use super::lines::{Wrong, in_field};
use super::repair::{self, finite, kind, optional, pedestrian, required, whole};

/// Lines and fields of other names may stand between.
#[derive(Debug, Deserialize)]
pub(super) struct Line {
    pub(super) scene: Option<Scene>,
    pub(super) track: Option<Track>,
}

/// `recording` is an addition of ours, for folds of several recordings.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct Scene {
    pub(super) id: i64,
    pub(super) p: PedestrianName,
    pub(super) s: i64,
    pub(super) e: i64,
    pub(super) recording: Option<String>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Track {
    pub(super) f: i64,
    pub(super) p: PedestrianName,
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) prediction_number: Option<i64>,
    pub(super) scene_id: Option<i64>,
}

/// The fields that are read.
const FIELDS: [&str; 12] = [
    "scene",
    "track",
    "id",
    "p",
    "s",
    "e",
    "recording",
    "f",
    "x",
    "y",
    "prediction_number",
    "scene_id",
];

impl Line {
    /// A line is read as a whole, and field by field where that failed, to name the field.
    pub(super) fn read(text: &str) -> Result<Self, Wrong> {
        serde_json::from_str(text).or_else(|_| field_by_field(text))
    }
}

fn field_by_field(text: &str) -> Result<Line, Wrong> {
    let object = repair::object(text, &FIELDS)?;
    Ok(Line {
        scene: section(&object, "scene", scene)?,
        track: section(&object, "track", track)?,
    })
}

fn section<T>(
    object: &Map<String, Value>,
    key: &str,
    read: impl Fn(&Map<String, Value>) -> Result<T, Wrong>,
) -> Result<Option<T>, Wrong> {
    match optional(object, key) {
        None => Ok(None),
        Some(Value::Object(section)) => read(section).map(Some),
        Some(other) => Err(in_field(key, kind("an object", other))),
    }
}

fn scene(object: &Map<String, Value>) -> Result<Scene, Wrong> {
    let number = |key: &str| {
        let path = format!("scene.{key}");
        whole(required(object, key, &path)?, &path)
    };
    let recording = match optional(object, "recording") {
        None => None,
        Some(Value::String(name)) => Some(name.clone()),
        Some(other) => return Err(in_field("scene.recording", kind("a name in quotes", other))),
    };
    Ok(Scene {
        id: number("id")?,
        p: pedestrian(required(object, "p", "scene.p")?, "scene.p")?,
        s: number("s")?,
        e: number("e")?,
        recording,
    })
}

fn track(object: &Map<String, Value>) -> Result<Track, Wrong> {
    let number = |key: &str| {
        let path = format!("track.{key}");
        whole(required(object, key, &path)?, &path)
    };
    let or_none = |key: &str| match optional(object, key) {
        None => Ok(None),
        Some(value) => whole(value, &format!("track.{key}")).map(Some),
    };
    let coordinate = |key: &str| {
        let path = format!("track.{key}");
        finite(required(object, key, &path)?, &path)
    };
    Ok(Track {
        f: number("f")?,
        p: pedestrian(required(object, "p", "track.p")?, "track.p")?,
        x: coordinate("x")?,
        y: coordinate("y")?,
        prediction_number: or_none("prediction_number")?,
        scene_id: or_none("scene_id")?,
    })
}
