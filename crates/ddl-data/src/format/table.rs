//! The `table` format: comma-separated, with a header, for the user's own tracks.

use csv::{ErrorKind, StringRecord};

use crate::clock::TimeUnit;
use crate::error::FormatError;
use crate::format::field;
use crate::format::place::FilePlace;
use crate::format::problem::{EMPTY, field_count};
use crate::format::rows::{FIELDS, TrackRow};
use crate::scene_name::SceneName;

/// Number of unknown columns that an error names.
const UNKNOWN_NAMED: usize = 5;
const COLUMNS: [&str; 4] = ["frame", "pedestrian", "x", "y"];
/// An optional column, only for streams.
const SCENE: &str = "scene";
const FEWER: &str = "frame, pedestrian, x, y; a comma stands between two fields, not at the end of a row and not for \
    a decimal point";
/// The fields of a row that is one field.
const ONE: &str = "frame, pedestrian, x, y, separated by commas";

const FRACTIONS: &str = "the column frame has fractions: it is read as seconds";
const WHOLE_TIMES: &str = "the times are whole numbers: they are read as seconds; call the column frame if they count \
    frames, or time_ms, time_us or time_ns";

/// For a row with too few or too many fields.
fn wrong_count(expected: usize, found: usize) -> String {
    let names = match found {
        _ if expected > COLUMNS.len() => "frame, pedestrian, x, y and scene",
        1 => ONE,
        _ if found > expected => FEWER,
        _ => FIELDS,
    };
    field_count(expected, found, names)
}

/// The rows, and notes on the columns.
pub(super) fn parse(text: &str, origin: &str) -> Result<(Vec<TrackRow>, Vec<String>), FormatError> {
    if text.trim().is_empty() {
        return Err(FilePlace::line(1).wrong(origin, EMPTY));
    }
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let header = reader.headers().map_err(|e| table_error(&e, origin))?;
    let mut columns = TrackColumns::of(header, 1, origin)?;
    let records: Result<Vec<StringRecord>, _> = reader.records().collect();
    let records = records.map_err(|e| table_error(&e, origin))?;
    columns.look_at(&records);
    let rows = records.iter().map(|record| {
        let line = record.position().map_or(1, |p| p.line() as usize);
        columns.row(record, line, origin)
    });
    Ok((rows.collect::<Result<_, _>>()?, columns.notes()))
}

#[derive(Debug)]
pub(super) struct TrackColumns {
    places: [usize; 4],
    scene: Option<usize>,
    count: usize,
    time: TimeColumn,
    /// Why the first column is read as seconds, if neither its name nor its values say so.
    assumed_seconds: Option<&'static str>,
    /// Names of further columns.
    unread: Vec<String>,
}

/// What the first column counts.
#[derive(Debug, Clone, Copy, PartialEq)]
enum TimeColumn {
    /// Frames, unless a value has a fraction: then seconds.
    Frame,
    /// Seconds or dates, as the first value says.
    Time,
    /// Frames, without a unit, or times.
    Known(Option<TimeUnit>),
}

impl TimeColumn {
    fn named(name: &str) -> Option<Self> {
        match name.to_ascii_lowercase().as_str() {
            "time" | "timestamp" | "t" => Some(Self::Time),
            "time_s" | "seconds" => Some(Self::Known(Some(TimeUnit::Seconds))),
            "time_ms" | "timestamp_ms" | "milliseconds" => Some(Self::Known(Some(TimeUnit::Milliseconds))),
            "time_us" | "timestamp_us" | "microseconds" => Some(Self::Known(Some(TimeUnit::Microseconds))),
            "time_ns" | "timestamp_ns" | "nanoseconds" => Some(Self::Known(Some(TimeUnit::Nanoseconds))),
            _ => None,
        }
    }
}

impl TrackColumns {
    pub(super) fn of_line(text: &str, line: usize, origin: &str) -> Result<Self, FormatError> {
        Self::of(&record(text, line, origin)?, line, origin)
    }

    pub(super) fn row_of_line(&mut self, text: &str, line: usize, origin: &str) -> Result<TrackRow, FormatError> {
        let record = record(text, line, origin)?;
        if record.len() != self.count {
            return Err(FilePlace::line(line).wrong(origin, wrong_count(self.count, record.len())));
        }
        let before = (self.time, self.assumed_seconds);
        self.look_at(std::slice::from_ref(&record));
        let row = self.row(&record, line, origin);
        if row.is_err() {
            (self.time, self.assumed_seconds) = before;
        }
        row
    }

    /// What a reader should know of the columns.
    pub(super) fn notes(&self) -> Vec<String> {
        let seconds = self.assumed_seconds.map(str::to_owned);
        let unread = match &self.unread[..] {
            [] => None,
            [name] => Some(format!("the column {name} is not read")),
            names => Some(format!("the columns {} are not read", names.join(", "))),
        };
        seconds.into_iter().chain(unread).collect()
    }

    /// Finds out what the column of the time counts, if these rows show it.
    fn look_at(&mut self, records: &[StringRecord]) {
        let mut fields = records.iter().filter_map(|record| record.get(self.places[0]));
        let first = fields.clone().next();
        let unit = match self.time {
            TimeColumn::Known(unit) => unit,
            TimeColumn::Time => fields.next().map(field::unit_of),
            TimeColumn::Frame => fields.any(field::has_fraction).then_some(TimeUnit::Seconds),
        };
        let is_whole = |field: &str| !field.contains('.');
        self.assumed_seconds = match self.time {
            TimeColumn::Frame if unit.is_some() => Some(FRACTIONS),
            TimeColumn::Time if unit == Some(TimeUnit::Seconds) && first.is_some_and(is_whole) => Some(WHOLE_TIMES),
            _ => self.assumed_seconds,
        };
        self.time = TimeColumn::Known(unit);
    }

    fn of(header: &StringRecord, line: usize, origin: &str) -> Result<Self, FormatError> {
        let wrong = |field: Option<usize>, detail: String| {
            let rule = "the header must name the columns frame (or time), pedestrian, x and y, each once";
            FilePlace { line, field }.wrong(origin, format!("{rule}: {detail}"))
        };
        if header.iter().all(|name| name.parse::<f64>().is_ok()) {
            let detail = "found numbers; put the line frame,pedestrian,x,y above them".to_owned();
            return Err(wrong(None, detail));
        }
        let (mut places, mut scene, mut time) = ([None; 4], None, TimeColumn::Frame);
        let mut unknown = Vec::new();
        for (index, name) in header.iter().enumerate() {
            // Spreadsheets may write column names in capitals.
            if name.eq_ignore_ascii_case(SCENE) && scene.is_none() {
                scene = Some(index);
                continue;
            }
            let named = TimeColumn::named(name);
            time = named.unwrap_or(time);
            let column = COLUMNS.iter().position(|c| name.eq_ignore_ascii_case(c));
            let column = column.or(named.map(|_| 0));
            let Some(column) = column else {
                unknown.push((index + 1, name));
                continue;
            };
            if places[column].replace(index).is_some() {
                let again = if column == 0 && header.iter().any(|name| name.eq_ignore_ascii_case(COLUMNS[0])) {
                    "is beside a column of times or frames; leave one of the two out"
                } else {
                    "appears twice"
                };
                return Err(wrong(Some(index + 1), format!("column {name} {again}")));
            }
        }
        // Columns that say that the rows are of another kind are refused, others are not read.
        let is_complete = places.iter().all(Option::is_some);
        let refused = |name: &str| !is_complete || matters(name, header);
        let mut refused = unknown.iter().filter(|(_, name)| refused(name)).peekable();
        if let Some(&&(first, _)) = refused.peek() {
            let messages = refused
                .take(UNKNOWN_NAMED)
                .map(|(_, name)| format!("unknown column {:?}; {}", field::quoted(name), advice(name, header)));
            return Err(wrong(Some(first), messages.collect::<Vec<_>>().join("; ")));
        }
        let unread = unknown.iter().map(|(_, name)| field::quoted(name)).collect();
        let mut columns = [0; 4];
        for ((column, place), name) in columns.iter_mut().zip(places).zip(COLUMNS) {
            *column = place.ok_or_else(|| wrong(None, format!("column {name} is missing")))?;
        }
        Ok(Self {
            places: columns,
            scene,
            count: header.len(),
            time,
            assumed_seconds: None,
            unread,
        })
    }

    fn row(&self, record: &StringRecord, line: usize, origin: &str) -> Result<TrackRow, FormatError> {
        let field = |column: usize| (column + 1, record.get(column).unwrap_or_default());
        let unit = match self.time {
            TimeColumn::Known(unit) => unit,
            TimeColumn::Frame | TimeColumn::Time => None,
        };
        let row = TrackRow::of(line, origin, unit, self.places.map(field))?;
        let Some(column) = self.scene else {
            return Ok(row);
        };
        let (number, text) = field(column);
        let scene = SceneName::new(text).map_err(|error| error.to_string());
        let scene = FilePlace::field(line, number).read(origin, scene)?;
        Ok(TrackRow {
            scene: Some(scene),
            ..row
        })
    }
}

/// Whether an unknown column says that the rows are no tracks of one scene.
fn matters(name: &str, header: &StringRecord) -> bool {
    let advice = advice(name, header);
    (advice != REMOVE && !name.is_empty()) || name.eq_ignore_ascii_case(SCENE)
}

const REMOVE: &str = "remove it";

fn advice(name: &str, header: &StringRecord) -> String {
    let is_named = |column: &str| header.iter().any(|name| name.eq_ignore_ascii_case(column));
    let letters = name.chars().filter(char::is_ascii_alphanumeric);
    let plain = letters.collect::<String>().to_ascii_lowercase();
    let meant = match plain.as_str() {
        "id" | "ped" | "pedid" | "pedestrianid" | "agent" | "agentid" | "track" | "trackid" | "person" | "personid"
        | "object" | "objectid" => Some("pedestrian"),
        "observeduntil" => {
            return "this is a table of forecasts; give the tracks that they were made from".to_owned();
        }
        "camera" | "cameraid" | "cam" | "camid" | "sceneid" | "scenename" if !is_named(SCENE) => {
            return "for `ddl forecast -` rename it scene, for anything else leave it out".to_owned();
        }
        "frameid" | "framenumber" | "frameno" | "framenr" | "frameindex" => Some("frame"),
        "posx" | "xpos" | "positionx" | "xm" | "px" | "centerx" | "worldx" => Some("x"),
        "posy" | "ypos" | "positiony" | "ym" | "py" | "centery" | "worldy" => Some("y"),
        _ => None,
    };
    let has_time = header.iter().any(|name| TimeColumn::named(name).is_some());
    let is_missing = |column: &&str| !(is_named(column) || *column == COLUMNS[0] && has_time);
    let missing: Vec<&str> = COLUMNS.into_iter().filter(is_missing).collect();
    if let Some(meant) = meant.filter(|meant| missing.contains(meant)) {
        return format!("rename it to {meant}");
    }
    if header.len() == 1 && name.contains(['{', '[']) {
        "this is not a table; tracks as JSON must be TrajNet++ ndjson, one object per line".to_owned()
    } else if name.contains([';', '\t']) {
        "separate columns by commas, and use a decimal point".to_owned()
    } else if missing.is_empty() {
        REMOVE.to_owned()
    } else {
        format!("still missing: {}; rename the column, or remove it", missing.join(", "))
    }
}

fn record(text: &str, line: usize, origin: &str) -> Result<StringRecord, FormatError> {
    // A CSV reader is costly to create for every line of a stream, and is only needed for quoted fields.
    let plain = text.trim_end_matches(['\r', '\n']);
    if !plain.contains(['"', '\r', '\n']) {
        return Ok(plain.split(',').map(str::trim).collect());
    }
    quoted_record(text, line, origin)
}

fn quoted_record(text: &str, line: usize, origin: &str) -> Result<StringRecord, FormatError> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut record = StringRecord::new();
    let read = reader.read_record(&mut record);
    read.map(|_| record)
        .map_err(|error| FilePlace::line(line).wrong(origin, malformed(&error)))
}

fn table_error(error: &csv::Error, origin: &str) -> FormatError {
    let line = error.position().map_or(1, |p| p.line() as usize);
    let problem = match error.kind() {
        ErrorKind::UnequalLengths { expected_len, len, .. } => wrong_count(*expected_len as usize, *len as usize),
        _ => malformed(error),
    };
    FilePlace::line(line).wrong(origin, problem)
}

fn malformed(error: &csv::Error) -> String {
    format!("not a well-formed table: {error}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_fast_path_splits_lines_like_the_csv_reader(text in "[a0., \t\u{a0}\r\n\"]{0,12}[a0,]\r?\n?") {
            let fields = record(&text, 1, "t").unwrap();
            prop_assert_eq!(fields, quoted_record(&text, 1, "t").unwrap());
        }
    }
}
