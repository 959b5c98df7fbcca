//! File formats of recordings: parsers from text to a checked [`Recording`]. A parser refuses anything that it does not
//! understand, and names file, line and field. The order of the rows does not matter. Only TrajNet++ and Edinburgh
//! allow lines of other kinds, and only TrajNet++ overlapping scenes that repeat a track; text may have further columns
//! and comments.

mod choice;
mod column_names;
mod comments;
mod edinburgh;
mod fault;
mod field;
mod header;
mod kind;
mod layouts;
mod lines;
mod order;
mod position_columns;
mod problem;
mod quoted;
mod recognise;
mod row_filter;
mod row_reader;
mod rows;
mod separator;
mod star_csv;
mod stream;
mod text;
mod track_columns;
mod trajnet;
mod vsp;
mod write;

use std::path::Path;

pub use choice::{ChoiceError, ColumnChoice};
pub use fault::{Fault, Field, FormatError, Problem, WrongValue};

pub use kind::Format;
pub use lines::TextLines;
pub use quoted::{escaped, quoted};
pub use stream::{Frame, FrameReader};
pub use write::write_recording;

use crate::file_error::DataError;
use crate::format::fault::FilePlace;
use crate::format::problem::NOT_UTF8;
use crate::format::text::TextFile;
use crate::recording::Recording;

/// Reads one file of tracks. The recording is named after the file, without its extension.
///
/// The frame step is the most common difference between successive frames (the smaller of two equally common ones).
/// Where that is wrong, set it with [`Recording::with_frame_step`].
///
/// # Errors
/// If the file cannot be read, or its content is wrong: see [`FormatError`](crate::FormatError).
pub fn read_recording(path: &Path, format: Format) -> Result<Recording, DataError> {
    let bytes = std::fs::read(path).map_err(|source| DataError::Read { path: path.to_owned(), source })?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Ok(parse_recording(&bytes, &path.display().to_string(), format)?.with_name(&*name))
}

/// Parses tracks from bytes. `origin` names the recording, and the file in error messages.
///
/// The frame step is inferred as in [`read_recording`].
///
/// # Errors
/// If the content is wrong: see [`FormatError`](crate::FormatError).
///
/// # Examples
/// ```
/// use ddl_data::{Format, parse_recording};
///
/// let text = b"frame,pedestrian,x,y\n0,1,2.0,3.0\n10,1,2.5,oops\n";
/// let error = parse_recording(text, "tracks.csv", Format::Table).unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "tracks.csv, line 3, field 4: y must be a finite number in metres, found \"oops\"",
/// );
/// ```
pub fn parse_recording(bytes: &[u8], origin: &str, format: Format) -> Result<Recording, DataError> {
    parse_columns(bytes, origin, format, &ColumnChoice::default())
}

/// Parses tracks from bytes, with the columns of text as the user says.
///
/// # Errors
/// As [`parse_recording`], and if columns are chosen in a format whose columns have no names.
pub fn parse_columns(
    bytes: &[u8],
    origin: &str,
    format: Format,
    choice: &ColumnChoice,
) -> Result<Recording, DataError> {
    let read = rows_of(bytes, format, choice).map_err(|error| error.in_text(origin))?;
    let reader = read.reader.as_ref();
    let scene = read.rows.first().and_then(|row| row.scene.clone());
    let advice_on_same = |lines| TextFile::advice_on_same(reader, bytes, lines);
    let mut recording = rows::into_recording(read.rows, origin, advice_on_same)?;
    // The rate of comments is that of the frame numbers, that of TrajNet++ that of the rows.
    recording.rate = match (read.rate, recording.time_unit()) {
        (_, Some(_)) => None,
        (rate, None) if format == Format::TrajNet => rate,
        (rate, None) => rate.map(|rate| rate / recording.frame_step() as f64),
    };
    recording.notes = read.notes;
    let of_scene = scene.map(|scene| format!("all rows are of scene {scene}; forecasts of a file do not name it"));
    recording.notes.extend(of_scene);
    Ok(recording)
}

/// The observations of a file.
fn rows_of(bytes: &[u8], format: Format, choice: &ColumnChoice) -> Result<TextFile, FormatError> {
    if let Some((_, problem)) = OTHERS.iter().find(|(first, _)| first.iter().any(|first| bytes.starts_with(first))) {
        return Err(FilePlace::line(1).wrong(*problem));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = bytes[..error.valid_up_to()].split(|&byte| byte == b'\n').count();
        FilePlace::line(line).wrong(NOT_UTF8)
    })?;
    // Spreadsheets start UTF-8 text with a byte-order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if matches!(format, Format::StarCsv | Format::TrajNet | Format::Vsp | Format::Edinburgh) {
        FilePlace::line(1).read(choice.refuse_for(format))?;
    }
    match format {
        Format::StarCsv => Ok(TextFile::without_columns(star_csv::parse(text)?, None, None)),
        Format::TrajNet => {
            let (rows, others) = trajnet::parse(text)?;
            Ok(TextFile::without_columns(rows, others.filter.left_out(), others.frames_a_second))
        }
        Format::Vsp => vsp::parse(text, choice),
        Format::Edinburgh => edinburgh::parse(text, choice),
        _ => text::parse(text, format, choice),
    }
}

/// First bytes of files of other kinds, and what is said of them. Zip also holds spreadsheets.
const OTHERS: [(&[&[u8]], &str); 5] = [
    (
        &[b"\x1f\x8b", b"PK\x03\x04", b"BZh", b"\xfd7zXZ", b"\x28\xb5\x2f\xfd"],
        "the file is compressed; unpack it, or export the spreadsheet as csv",
    ),
    (
        &[b"PAR1"],
        "the file is Parquet; write it as csv first (python -c \"import pandas; \
         pandas.read_parquet('FILE').to_csv('FILE.csv')\"), or give its columns to the Python package",
    ),
    (
        &[
            b"SQLite format 3",
            b"\x89HDF",
            b"\x93NUMPY",
            b"MATLAB 5.0",
            b"\x80\x04",
            b"\x80\x05",
            b"#ROSBAG",
            b"\xd0\xcf\x11\xe0",
        ],
        "the file is binary (SQLite, HDF5, numpy, MATLAB, pickle, bag or old Excel); write its tracks as csv first",
    ),
    (&[b"<?xml", b"<!", b"<html", b"<gpx", b"\xef\xbb\xbf<"], "the file is XML or HTML; write its tracks as csv first"),
    (&[b"version https://git-lfs"], "the file is a pointer of Git LFS; get its content with `git lfs pull`"),
];
