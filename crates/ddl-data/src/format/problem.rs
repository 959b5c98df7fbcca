//! What can be wrong in a file of tracks; each message says how to solve it.

use ddl_core::PedestrianName;
use thiserror::Error;

use crate::observation::COORDINATE_LIMIT;
use crate::scene_name::{SceneName, SceneNameError};

/// A problem at one place of a file.
#[derive(Debug, PartialEq, Eq, Error)]
pub(super) enum FormatProblem {
    #[error("the file holds no observation; is it empty or cut off?")]
    Empty,
    #[error("the text is not UTF-8; export the file as plain UTF-8 or ASCII text")]
    NotUtf8,
    #[error("the file is compressed; unpack it, or export the spreadsheet as csv")]
    Compressed,
    #[error("line missing: the format has exactly {expected} lines ({names}), the file ends here")]
    MissingLine { expected: usize, names: &'static str },
    #[error("unexpected line: the format has exactly {expected} lines")]
    ExtraLine { expected: usize },
    #[error("{found} fields, but line 1 has {expected}; all lines must have the same number of fields")]
    UnequalLines { expected: usize, found: usize },
    #[error("{found} fields where {expected} are expected ({names})")]
    FieldCount {
        expected: usize,
        found: usize,
        names: &'static str,
    },
    #[error("the header must name the columns frame, pedestrian, x and y, each once: {detail}")]
    Header { detail: String },
    #[error("{name} must be {}, found {found:?}{}", wanted(.name), advice_on_integer(.name, .found))]
    NotInteger { name: &'static str, found: String },
    #[error("{name} must be a finite number in metres, found {found:?}{}", advice_on_number(.found))]
    NotFinite { name: &'static str, found: String },
    #[error(
        "{name} must lie within {limit} m of the origin, found {found:?}; use an origin near the scene",
        limit = COORDINATE_LIMIT
    )]
    TooFar { name: &'static str, found: String },
    #[error("{name} must be a number, found {found:?}")]
    NotNumber { name: &'static str, found: String },
    #[error("the line must be one JSON object (which has no NaN and no Infinity): {detail}")]
    Json { detail: String },
    #[error("{name} must be a JSON object, found {found}")]
    NotObject { name: &'static str, found: String },
    #[error("{name} is missing")]
    MissingField { name: &'static str },
    #[error("scene.fps must be a number above 0, the frames in a second, found {found}")]
    Rate { found: String },
    #[error("scene.fps is {found}, but {first} on line {first_line}; a file holds one recording with one frame rate")]
    RateChanges {
        first_line: usize,
        first: String,
        found: String,
    },
    #[error(
        "pedestrian {pedestrian} is in frame {frame} at {found}, but on line {first_line} at {first}; \
         overlapping scenes must agree"
    )]
    Disagreement {
        pedestrian: Box<PedestrianName>,
        frame: i64,
        first_line: usize,
        first: String,
        found: String,
    },
    #[error("pedestrian {pedestrian} is in frame {frame} already (line {first_line}); keep one row")]
    Duplicate {
        pedestrian: Box<PedestrianName>,
        frame: i64,
        first_line: usize,
    },
    #[error(
        "frame {frame}{} comes after frame {last}; a stream of tracks must be in order of time",
        of(.scene.as_ref())
    )]
    OutOfOrder {
        scene: Option<SceneName>,
        frame: i64,
        last: i64,
    },
    #[error(transparent)]
    Scene(#[from] SceneNameError),
    #[error("track.scene must be a text, such as \"hall\", found {found}")]
    SceneIsNoText { found: String },
    #[error(
        "{} on line {first_line}; name the scene of every observation or omit it everywhere",
        if *.named { "a scene is named here, but not" } else { "track.scene is missing here, but present" }
    )]
    MixedScenes { named: bool, first_line: usize },
    #[error(
        "scene {scene} exceeds the limit of {limit} scenes; a scene is forgotten after {minutes} minutes without a \
         line; \
         give the other scenes to another `ddl forecast -`"
    )]
    TooManyScenes {
        scene: SceneName,
        limit: usize,
        minutes: u64,
    },
    #[error(
        "a file holds one recording, but this one names scenes; pipe it to `ddl forecast -`, or make a file of each \
         scene without the column"
    )]
    ScenesInFile,
    #[error(
        "more than {limit} pedestrians in {}; does the frame number increase?",
        crowded(.scene.as_ref(), *.frame)
    )]
    Crowd {
        scene: Option<SceneName>,
        frame: i64,
        limit: usize,
    },
    #[error("the line is longer than {limit} bytes; is it a file of tracks?")]
    LongLine { limit: usize },
    #[error("not a well-formed table: {detail}")]
    Table { detail: String },
}

fn of(scene: Option<&SceneName>) -> String {
    scene.map(|scene| format!(" of scene {scene}")).unwrap_or_default()
}

/// Names a frame for the message about too many pedestrians.
fn crowded(scene: Option<&SceneName>, frame: i64) -> String {
    match scene {
        None => format!("frame {frame}"),
        Some(scene) => {
            format!("the incomplete frames, one of them frame {frame} of scene {scene}")
        }
    }
}

fn wanted(name: &str) -> &'static str {
    match name {
        "pedestrian" => "a whole number or a word",
        _ => "a whole number below 2^53 in size",
    }
}

/// Advice for a frame or pedestrian number that is not a whole number.
fn advice_on_integer(name: &str, found: &str) -> &'static str {
    let is_number = found.parse::<f64>().is_ok_and(f64::is_finite);
    match name {
        "frame" if is_number && found.contains('.') => "; is it a time? Count frames instead: 0, 1, 2, and so on",
        _ => advice_on_number(found),
    }
}

fn advice_on_number(found: &str) -> &'static str {
    if found.is_empty() || found.eq_ignore_ascii_case("nan") {
        "; leave out the row where a pedestrian was not seen"
    } else if found.replacen(',', ".", 1).parse::<f64>().is_ok() && found.contains(',') {
        "; use a decimal point"
    } else {
        ""
    }
}
