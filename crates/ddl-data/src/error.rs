//! What can go wrong with recordings, said with the place and the remedy.

use std::path::PathBuf;

use thiserror::Error;

use crate::{Convention, PedestrianId, PedestrianName};

/// Why a file of tracks cannot be read: the file, the line, the field and the problem.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{origin}, line {line}{}: {problem}", .field.map(|f| format!(", field {f}")).unwrap_or_default())]
pub struct FormatError {
    /// The file, or whatever name was given to the bytes.
    pub origin: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Field within the line, counted from 1; `None` when the whole line is meant.
    pub field: Option<usize>,
    /// What is wrong there.
    pub problem: FormatProblem,
}

/// What can be wrong at one place of a file of tracks.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FormatProblem {
    /// The file holds no observation.
    #[error("the file holds no observation; is it empty or cut off?")]
    Empty,
    /// The bytes are not UTF-8 text.
    #[error("the text is not UTF-8; export the file as plain UTF-8 or ASCII text")]
    NotUtf8,
    /// The bytes are those of a compressed file, or of a spreadsheet, which is one.
    #[error("the file is compressed; unpack it, or export the spreadsheet as csv")]
    Compressed,
    /// A line is absent.
    #[error("line missing: the format has exactly {expected} lines ({names}), the file ends here")]
    MissingLine {
        /// Lines that the format has.
        expected: usize,
        /// What they hold.
        names: &'static str,
    },
    /// A line too many.
    #[error("unexpected line: the format has exactly {expected} lines")]
    ExtraLine {
        /// Lines that the format has.
        expected: usize,
    },
    /// Two lines that run in parallel differ in length.
    #[error("{found} fields, but line 1 has {expected}; all lines must be of one length")]
    UnequalLines {
        /// Fields of line 1.
        expected: usize,
        /// Fields of this line.
        found: usize,
    },
    /// A row has too few or too many fields.
    #[error("{found} fields where {expected} are expected ({names})")]
    FieldCount {
        /// Fields that a row has.
        expected: usize,
        /// Fields of this row.
        found: usize,
        /// What they hold.
        names: &'static str,
    },
    /// The header of a table lacks a column, or has one that is unknown or double.
    #[error("the header must name the columns frame, pedestrian, x and y, each once: {detail}")]
    Header {
        /// Which column is the trouble.
        detail: String,
    },
    /// A field that must be a whole number is none.
    #[error("{name} must be {}, found {found:?}{}", wanted(.name), advice_on_integer(.name, .found))]
    NotInteger {
        /// What the field holds: `frame` or `pedestrian`.
        name: &'static str,
        /// The field's text, shortened.
        found: String,
    },
    /// A field that must be a number is none, or is infinite or NaN.
    #[error("{name} must be a finite number in metres, found {found:?}{}", advice_on_number(.found))]
    NotFinite {
        /// What the field holds: `x` or `y`.
        name: &'static str,
        /// The field's text, shortened.
        found: String,
    },
    /// A coordinate farther from the origin than [`COORDINATE_LIMIT`](crate::COORDINATE_LIMIT).
    #[error(
        "{name} must lie within {limit} m of the origin, found {found:?}; count from an origin near by",
        limit = crate::COORDINATE_LIMIT
    )]
    TooFar {
        /// What the field holds: `x` or `y`.
        name: &'static str,
        /// The field's text, shortened.
        found: String,
    },
    /// A field that must be a number, whatever its value, is none.
    #[error("{name} must be a number, found {found:?}")]
    NotNumber {
        /// What the field holds, such as `v_x`.
        name: &'static str,
        /// The field's text, shortened.
        found: String,
    },
    /// A line is no JSON object.
    #[error("the line must be one JSON object (which has no NaN and no Infinity): {detail}")]
    Json {
        /// The reader's own words.
        detail: String,
    },
    /// A part of a JSON line that must be an object is something else.
    #[error("{name} must be a JSON object, found {found}")]
    NotObject {
        /// The part: `track` or `scene`.
        name: &'static str,
        /// What it is, shortened.
        found: String,
    },
    /// A JSON object lacks a field.
    #[error("{name} is missing")]
    MissingField {
        /// The field, such as `track.f`.
        name: &'static str,
    },
    /// The rate of a scene is no rate.
    #[error("scene.fps must be a number above 0, the frames in a second, found {found}")]
    Rate {
        /// What it is, shortened.
        found: String,
    },
    /// Scenes of one file name different rates.
    #[error(
        "scene.fps is {found}, but {first} on line {first_line}; a file is of one recording, whose frames have one rate"
    )]
    RateChanges {
        /// Line of the first rate.
        first_line: usize,
        /// The first rate.
        first: String,
        /// The rate of this line.
        found: String,
    },
    /// Overlapping scenes repeat a track with another position.
    #[error(
        "pedestrian {pedestrian} is in frame {frame} at {found}, but on line {first_line} at {first}; \
         scenes that overlap must agree"
    )]
    Disagreement {
        /// The pedestrian.
        pedestrian: Box<PedestrianName>,
        /// The raw frame number.
        frame: i64,
        /// Line of the first occurrence.
        first_line: usize,
        /// Where the pedestrian was there (m).
        first: String,
        /// Where the pedestrian is here (m).
        found: String,
    },
    /// One pedestrian twice in one frame.
    #[error("pedestrian {pedestrian} is in frame {frame} already (line {first_line}); keep one")]
    Duplicate {
        /// The pedestrian.
        pedestrian: Box<PedestrianName>,
        /// The raw frame number.
        frame: i64,
        /// Line of the first occurrence.
        first_line: usize,
    },
    /// A frame that is over comes again, or an earlier one.
    #[error(
        "frame {frame} comes after frame {last}; tracks that are read as they arrive must be in order of time"
    )]
    OutOfOrder {
        /// The raw frame number.
        frame: i64,
        /// That of the frame before.
        last: i64,
    },
    /// More people in one frame than any place holds.
    #[error("more than {limit} people in frame {frame}; does the frame number count on?")]
    Crowd {
        /// The raw frame number.
        frame: i64,
        /// People that a frame may have.
        limit: usize,
    },
    /// A line without an end.
    #[error("the line is longer than {limit} bytes; is it a file of tracks?")]
    LongLine {
        /// Bytes that a line may have.
        limit: usize,
    },
    /// The text is no well-formed comma-separated table.
    #[error("not a well-formed table: {detail}")]
    Table {
        /// The reader's own words.
        detail: String,
    },
}

/// What a field of whole numbers may hold.
fn wanted(name: &str) -> &'static str {
    match name {
        "pedestrian" => "a whole number or a word",
        _ => "a whole number below 2^53 in size",
    }
}

/// What to do about a number of a frame or of a person that is no whole one.
fn advice_on_integer(name: &str, found: &str) -> &'static str {
    let is_number = found.parse::<f64>().is_ok_and(f64::is_finite);
    match name {
        "frame" if is_number && found.contains('.') => {
            "; is it a time? Count frames instead: 0, 1, 2, and so on"
        }
        _ => advice_on_number(found),
    }
}

/// What to do about text that is no number.
fn advice_on_number(found: &str) -> &'static str {
    if found.is_empty() || found.eq_ignore_ascii_case("nan") {
        "; where somebody was not seen, write no row"
    } else if found.replacen(',', ".", 1).parse::<f64>().is_ok() && found.contains(',') {
        "; write decimals with a point"
    } else {
        ""
    }
}

/// Why observations do not make a [`Recording`](crate::Recording).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// No observation.
    #[error("a recording needs at least one observation")]
    Empty,
    /// The frame step is not positive, or absurdly large.
    #[error("the frame step must lie in 1..=2^31 raw frames, found {found}")]
    FrameStep {
        /// The step given.
        found: i64,
    },
    /// A frame number too large to count on from.
    #[error("pedestrian {pedestrian}: frame {frame} is not below 2^53 in size")]
    FrameOutOfRange {
        /// The pedestrian.
        pedestrian: PedestrianId,
        /// The raw frame number.
        frame: i64,
    },
    /// A coordinate is infinite or NaN.
    #[error("pedestrian {pedestrian}, frame {frame}: position {position:?} is not finite")]
    NotFinite {
        /// The pedestrian.
        pedestrian: PedestrianId,
        /// The raw frame number.
        frame: i64,
        /// The position (m).
        position: crate::Position,
    },
    /// One pedestrian twice in one frame.
    #[error("pedestrian {pedestrian} is in frame {frame} twice")]
    Duplicate {
        /// The pedestrian.
        pedestrian: PedestrianId,
        /// The raw frame number.
        frame: i64,
    },
}

/// Why tracks do not make a [`Window`](crate::Window).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum WindowError {
    /// No pedestrian.
    #[error("a window needs at least one pedestrian")]
    Empty,
    /// Ids and tracks differ in number.
    #[error("{pedestrians} pedestrian ids but {tracks} tracks; give one track for each id")]
    Count {
        /// Number of ids.
        pedestrians: usize,
        /// Number of tracks.
        tracks: usize,
    },
    /// A track is of a wrong length.
    #[error(
        "pedestrian {pedestrian}: a track of {found} positions; every track of a window must have \
         {observed} (observation only) or every one {whole} (with the future)",
        observed = crate::OBSERVED,
        whole = crate::WINDOW
    )]
    Length {
        /// The pedestrian.
        pedestrian: PedestrianId,
        /// Positions of the track.
        found: usize,
    },
    /// A coordinate is infinite or NaN.
    #[error("pedestrian {pedestrian}, position {index} of the track: {position:?} is not finite")]
    NotFinite {
        /// The pedestrian.
        pedestrian: PedestrianId,
        /// Index within the track, from 0.
        index: usize,
        /// The position (m).
        position: crate::Position,
    },
    /// One id twice.
    #[error("pedestrian {pedestrian} is in the window twice")]
    Duplicate {
        /// The pedestrian.
        pedestrian: PedestrianId,
    },
    /// The frame step or the frame numbers are out of range.
    #[error(
        "start frame {start_frame} with a step of {frame_step}: the step must lie in 1..=2^31 and frames below 2^53"
    )]
    Frames {
        /// First raw frame.
        start_frame: i64,
        /// Raw frames a step.
        frame_step: i64,
    },
}

/// Why a data set, or one file of it, cannot be had.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DataError {
    /// A file cannot be read from the disk.
    #[error("cannot read {}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A file's content is wrong.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// Observations that do not make a recording.
    #[error("recording {name}: {source}")]
    Recording {
        /// The recording.
        name: String,
        /// What is wrong with it.
        source: RecordingError,
    },
    /// The convention's files were not found.
    #[error(
        "the {convention} recordings are not there; looked in {}. Put the files there, or name \
         their folder in the environment variable {variable}",
        .searched.join(", "),
        variable = crate::DATASETS_VARIABLE
    )]
    NotFound {
        /// The convention whose files were looked for.
        convention: Convention,
        /// Each folder that was tried, with the first file it lacks.
        searched: Vec<String>,
    },
    /// A convention without files of fixed names was asked for them.
    #[error(
        "the {0} convention has no files of fixed names; use `Dataset::simulated` or `Dataset::own`"
    )]
    NoFiles(Convention),
    /// Own recordings that do not make a data set.
    #[error("{problem}")]
    Own {
        /// What is wrong with them, and what to do.
        problem: String,
    },
    /// No recording of this name.
    #[error("no recording {name:?} in the {convention} convention; it has {}", .known.join(", "))]
    UnknownRecording {
        /// The convention.
        convention: Convention,
        /// The name asked for.
        name: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// A recording to set apart that the fold does not train on.
    #[error("{name:?} is not one of these recordings: {}", .known.join(", "))]
    NotATrainingRecording {
        /// The fold.
        fold: String,
        /// The name asked for.
        name: String,
        /// The training recordings.
        known: Vec<String>,
    },
    /// No fold of this name.
    #[error("no fold {name:?} in the {convention} convention; it has {}", .known.join(", "))]
    UnknownFold {
        /// The convention.
        convention: Convention,
        /// The name asked for.
        name: String,
        /// The names there are.
        known: Vec<String>,
    },
}
