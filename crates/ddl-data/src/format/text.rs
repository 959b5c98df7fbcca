//! Text with one observation per line: tables with a header, and the layouts without one.

use std::borrow::Cow;
use std::collections::BTreeMap;

use ddl_core::Position;

use crate::clock::TimeUnit;
use crate::error::FormatError;
use crate::format::choice::ColumnChoice;
use crate::format::column_names::LengthUnit;
use crate::format::field::{self, PedestrianField};
use crate::format::header::{Header, TimeColumn, first_of};
use crate::format::kind::Format;
use crate::format::layouts::{Layout, Place};
use crate::format::place::FilePlace;
use crate::format::problem::{EMPTY, field_count};
use crate::format::rows::TrackRow;
use crate::format::separator::Separator;
use crate::scene_name::SceneName;

/// Begins a line that holds no observation.
pub(super) const COMMENT: char = '#';
const FRACTIONS: &str = "the column frame has fractions: it is read as seconds";
const WHOLE_TIMES: &str = "the times are whole numbers: they are read as seconds; call the column frame if they count \
    frames, or time_ms, time_us or time_ns";
pub(crate) const PIXELS: &str = "the positions are in pixels, and forecasts need metres: give --homography";
/// Classes that are not people on foot. A row of one of them is left out.
const VEHICLES: [&str; 22] = [
    "car",
    "cars",
    "veh",
    "vehicle",
    "truck",
    "bus",
    "van",
    "trailer",
    "tram",
    "train",
    "bicycle",
    "bicyclist",
    "cyclist",
    "biker",
    "bike",
    "motorcycle",
    "motorcyclist",
    "motorbike",
    "scooter",
    "skater",
    "cart",
    "trucks",
];
/// Reasons to leave rows out that are counted, each for itself.
const MOST_REASONS: usize = 20;
/// A position that is to be forecast (TrajNet).
const UNKNOWN: &str = "?";

/// The observations of a file of text.
#[derive(Debug)]
pub(super) struct TextFile {
    pub(super) rows: Vec<TrackRow>,
    pub(super) notes: Vec<String>,
    /// Frames a second, if a comment states it.
    pub(super) rate: Option<f64>,
}

/// The columns of a text, and what was found in its rows.
#[derive(Debug)]
pub(super) struct TrackColumns {
    separator: Separator,
    names: Vec<String>,
    frame: usize,
    pedestrian: usize,
    place: Place,
    per_metre: Option<f64>,
    scene: Option<usize>,
    class: Option<ClassColumn>,
    lost: Option<usize>,
    /// A column whose value stays the same, and its value.
    constant: Option<(usize, Option<f64>)>,
    /// Further columns that must hold numbers.
    numbers: Vec<usize>,
    time: TimeColumn,
    /// Why the first column is read as seconds, if neither its name nor its values say so.
    assumed_seconds: Option<&'static str>,
    /// Names of further columns.
    unread: Vec<String>,
    note: Option<&'static str>,
    left_out: BTreeMap<String, usize>,
    /// For how many reasons a stream has told that it leaves rows out; `None` before its first notes.
    told: Option<usize>,
}

#[derive(Debug)]
struct ClassColumn {
    index: usize,
    /// The class that is read; `None` for all but vehicles.
    kept: Option<String>,
}

/// The rows of a text, of a table if no layout is given.
pub(super) fn parse(text: &str, origin: &str, format: Format, choice: &ColumnChoice) -> Result<TextFile, FormatError> {
    // Old spreadsheets end lines with a carriage return alone.
    let end = if text.contains('\n') { '\n' } else { '\r' };
    let lines = (1..).zip(text.split(end));
    let is_row = |text: &str| !text.trim().is_empty() && !is_comment(text);
    let filled = || lines.clone().filter(|(_, text)| is_row(text));
    let Some((first_line, first)) = filled().next() else {
        return Err(FilePlace::line(1).wrong(origin, EMPTY));
    };
    let comments: Vec<&str> = lines
        .clone()
        .map_while(|(_, text)| (!is_row(text)).then_some(text))
        .collect();
    let (mut columns, header) = TrackColumns::of((format, choice), &comments, first, first_line, origin)?;
    let rows = || filled().skip(usize::from(header));
    let fields = |line: usize, text| columns.separator.fields(text, line, origin);
    let mut times = Vec::new();
    if matches!(columns.time, TimeColumn::Frame) {
        let with_fraction = rows().find_map(|(line, text)| {
            let fields = fields(line, text).ok()?;
            let time = fields.get(columns.frame)?;
            field::has_fraction(time).then(|| time.to_string())
        });
        times.extend(with_fraction);
    } else if let Some((line, text)) = rows().next() {
        let time = fields(line, text)?.get(columns.frame).map(ToString::to_string);
        times.extend(time);
    }
    columns.look_at(times.first().map(String::as_str));
    let mut read = Vec::new();
    for (line, text) in rows() {
        read.extend(columns.row(text, line, origin)?);
    }
    let rate = comments.iter().find_map(|comment| rate_of(comment));
    Ok(TextFile {
        rows: read,
        notes: columns.notes().into_iter().chain(columns.count_of_rows()).collect(),
        rate,
    })
}

pub(super) fn is_comment(text: &str) -> bool {
    text.trim_start().starts_with(COMMENT)
}

/// The rate that a comment states, such as `# framerate: 16 fps`.
pub(super) fn rate_of(comment: &str) -> Option<f64> {
    let text = comment.to_ascii_lowercase();
    let after = ["framerate", "frame rate", "frame_rate", "fps"]
        .iter()
        .find_map(|word| {
            let (_, after) = text.split_once(word)?;
            Some(after)
        })?;
    let number = after.trim_start_matches([':', '=', ' ', '\t']);
    let end = number
        .find(|c: char| !(c.is_ascii_digit() || c == '.'))
        .unwrap_or(number.len());
    number[..end].parse().ok().filter(|rate| *rate > 0.0)
}

/// Whether a line of fields is one of observations and no header: some field is a number.
pub(super) fn has_number(fields: &[Cow<'_, str>]) -> bool {
    fields.iter().any(|field| field.parse::<f64>().is_ok())
}

impl TrackColumns {
    /// The columns of a text that begins with these comments and this line, and whether the line is their header.
    pub(super) fn of(
        (format, choice): (Format, &ColumnChoice),
        comments: &[&str],
        first: &str,
        line: usize,
        origin: &str,
    ) -> Result<(Self, bool), FormatError> {
        if let Some(layout) = Layout::of(format) {
            let columns = Self::laid_out(layout, Separator::of_numbers(first), choice);
            return Ok((
                columns.map_err(|problem| FilePlace::line(line).wrong(origin, problem))?,
                false,
            ));
        }
        let separator = Separator::of(first);
        let fields = separator.fields(first, line, origin)?;
        if has_number(&fields)
            && let Some((header, names)) = comments.iter().rev().find_map(|comment| in_comment(comment, choice))
        {
            return Ok((Self::named(header, names, Separator::of_numbers(first)), false));
        }
        let names: Vec<&str> = fields.iter().map(|field| &**field).collect();
        match Header::of(&names, choice) {
            Ok(header) => {
                let names = names.iter().map(|&name| name.to_owned()).collect();
                Ok((Self::named(header, names, separator), true))
            }
            Err((field, problem)) => {
                let field = field.map(|index| index + 1);
                Err(FilePlace { line, field }.wrong(origin, problem))
            }
        }
    }

    fn named(header: Header, names: Vec<String>, separator: Separator) -> Self {
        Self {
            separator,
            names,
            frame: header.frame,
            pedestrian: header.pedestrian,
            place: header.place,
            per_metre: header.per_metre,
            scene: header.scene,
            class: match header.keep {
                Some((index, kept)) => Some(ClassColumn {
                    index,
                    kept: Some(kept),
                }),
                None => header.class.map(|index| ClassColumn { index, kept: None }),
            },
            lost: None,
            constant: None,
            numbers: Vec::new(),
            time: header.time,
            assumed_seconds: None,
            unread: header.unread,
            note: None,
            left_out: BTreeMap::new(),
            told: None,
        }
    }

    fn laid_out(layout: &Layout, separator: Separator, choice: &ColumnChoice) -> Result<Self, String> {
        let kept = match &choice.keep {
            None => layout.class.map(|(index, kept)| (index, kept.to_owned())),
            Some((name, value)) => {
                let index = layout.names.iter().position(|column| column.eq_ignore_ascii_case(name));
                let columns = || layout.names.join(", ");
                let index = index.ok_or_else(|| format!("there is no column {name:?} among {}", columns()))?;
                Some((index, value.clone()))
            }
        };
        if let Some((_, name)) = choice.roles.first() {
            return Err(format!(
                "there is no header, so no column is called {name:?}; write one above the rows"
            ));
        }
        let class = kept.map(|(index, kept)| ClassColumn {
            index,
            kept: Some(kept),
        });
        let is_class = |index: usize| class.as_ref().is_some_and(|class| class.index == index);
        let of_row = [layout.frame, layout.pedestrian];
        let numbers = (0..layout.names.len())
            .filter(|index| !of_row.contains(index) && !layout.place.columns().contains(index) && !is_class(*index));
        Ok(Self {
            separator,
            names: layout.names.iter().map(|&name| name.to_owned()).collect(),
            frame: layout.frame,
            pedestrian: layout.pedestrian,
            place: layout.place,
            per_metre: choice.unit.map_or(layout.per_metre, LengthUnit::per_metre),
            scene: None,
            numbers: numbers.collect(),
            class,
            lost: layout.lost,
            constant: layout.constant.map(|index| (index, None)),
            time: match layout.names[layout.frame] {
                "time" => TimeColumn::Known(Some(TimeUnit::Seconds)),
                _ => TimeColumn::Frame,
            },
            assumed_seconds: None,
            unread: Vec::new(),
            note: layout.note,
            left_out: BTreeMap::new(),
            told: None,
        })
    }

    /// The observation of a line of a stream; `None` where it is left out.
    pub(super) fn row_of_line(
        &mut self,
        text: &str,
        line: usize,
        origin: &str,
    ) -> Result<Option<TrackRow>, FormatError> {
        let before = (self.time, self.assumed_seconds);
        let fields = self.separator.fields(text, line, origin)?;
        self.look_at(fields.get(self.frame).map(|field| &**field));
        let row = self.row(text, line, origin);
        if row.is_err() {
            (self.time, self.assumed_seconds) = before;
        }
        row
    }

    /// What a stream has not told yet.
    pub(super) fn new_notes(&mut self) -> Vec<String> {
        let reasons = self.left_out.len();
        let mut notes = match self.told {
            None => self.notes(),
            Some(_) => Vec::new(),
        };
        if self.told.replace(reasons).unwrap_or(0) < reasons {
            let reasons: Vec<String> = self.left_out.keys().cloned().collect();
            notes.push(format!("rows are left out: {}", first_of(&reasons)));
        }
        notes
    }

    /// The rows that were left out, counted by reason.
    fn count_of_rows(&self) -> Option<String> {
        let rows: Vec<String> = self
            .left_out
            .iter()
            .map(|(why, count)| format!("{count} {why}"))
            .collect();
        (!rows.is_empty()).then(|| format!("rows left out: {}", first_of(&rows)))
    }

    /// What a reader should know of the columns.
    fn notes(&self) -> Vec<String> {
        let mut notes: Vec<String> = self.note.into_iter().map(str::to_owned).collect();
        notes.extend(self.assumed_seconds.map(str::to_owned));
        match &self.unread[..] {
            [] => {}
            [name] => notes.push(format!("the column {name} is not read")),
            names => notes.push(format!("the columns {} are not read", first_of(names))),
        }
        match self.per_metre {
            None => notes.push(PIXELS.to_owned()),
            Some(1000.0) if self.note.is_none() => notes.push("the positions are in millimetres".to_owned()),
            Some(100.0) if self.note.is_none() => notes.push("the positions are in centimetres".to_owned()),
            Some(_) => {}
        }
        notes
    }

    /// Finds out what the column of the time counts from a time: a first one, or one with a fraction.
    fn look_at(&mut self, time: Option<&str>) {
        let unit = match self.time {
            TimeColumn::Known(unit) => unit,
            TimeColumn::Time => time.map(field::unit_of),
            TimeColumn::Frame => time.is_some_and(field::has_fraction).then_some(TimeUnit::Seconds),
        };
        let is_whole = |time: &str| !time.contains('.');
        self.assumed_seconds = match self.time {
            TimeColumn::Frame if unit.is_some() => Some(FRACTIONS),
            TimeColumn::Time if unit == Some(TimeUnit::Seconds) && time.is_some_and(is_whole) => Some(WHOLE_TIMES),
            _ => self.assumed_seconds,
        };
        self.time = TimeColumn::Known(unit);
    }

    /// The observation of a line; `None` where it is left out.
    fn row(&mut self, text: &str, line: usize, origin: &str) -> Result<Option<TrackRow>, FormatError> {
        let fields = self.separator.fields(text, line, origin)?;
        let (names, found) = (self.names.len(), fields.len());
        // Rows and the header may end with separators.
        let unnamed = self.names.iter().rev().take_while(|name| name.is_empty()).count();
        if found < names - unnamed || fields[names.min(found)..].iter().any(|field| !field.is_empty()) {
            return Err(FilePlace::line(line).wrong(origin, self.wrong_count(found)));
        }
        if let Some(mut why) = self.left_out(&fields) {
            if self.left_out.len() == MOST_REASONS && !self.left_out.contains_key(&why) {
                "of other classes".clone_into(&mut why);
            }
            *self.left_out.entry(why).or_default() += 1;
            return Ok(None);
        }
        let place = |index: usize| FilePlace::field(line, index + 1);
        let unit = match self.time {
            TimeColumn::Known(unit) => unit,
            TimeColumn::Frame | TimeColumn::Time => None,
        };
        let frame = place(self.frame).read(origin, field::frame(&fields[self.frame], "frame", unit))?;
        let pedestrian = field::pedestrian(&fields[self.pedestrian], "pedestrian");
        let mut pedestrian = place(self.pedestrian).read(origin, pedestrian)?;
        if self.constant.is_some() {
            // Pedestrians are floats in this format, never words.
            let number = place(self.pedestrian).read(origin, field::integer(&fields[self.pedestrian], "pedestrian"))?;
            pedestrian = PedestrianField::Number(number, None);
        }
        let position = self.position(&fields, line, origin)?;
        // Columns that are not used. Checking that they are numbers confirms the order of the columns.
        for &index in &self.numbers {
            place(index).read(origin, field::number(&fields[index], &self.names[index]))?;
        }
        self.check_constant(&fields, line, origin)?;
        let scene = match self.scene {
            None => None,
            Some(index) => {
                let scene = SceneName::new(&fields[index]).map_err(|error| error.to_string());
                Some(place(index).read(origin, scene)?)
            }
        };
        Ok(Some(TrackRow {
            scene,
            frame,
            unit,
            pedestrian,
            position,
            place: FilePlace::line(line),
        }))
    }

    /// Why a row is left out.
    fn left_out(&self, fields: &[Cow<'_, str>]) -> Option<String> {
        if self.lost.is_some_and(|index| fields[index] == "1") {
            return Some("marked lost".to_owned());
        }
        if let Some(ClassColumn { index, kept }) = &self.class {
            let class = &*fields[*index];
            let is_other = match kept {
                Some(kept) => !class.eq_ignore_ascii_case(kept),
                None => VEHICLES.iter().any(|vehicle| class.eq_ignore_ascii_case(vehicle)),
            };
            if is_other {
                return Some(format!("of class {}", field::quoted(class)));
            }
        }
        let is_unknown = self.place.columns().iter().all(|&index| fields[index] == UNKNOWN);
        is_unknown.then(|| "with ? for a position to forecast".to_owned())
    }

    fn position(&self, fields: &[Cow<'_, str>], line: usize, origin: &str) -> Result<Position, FormatError> {
        let per_metre = self.per_metre.unwrap_or(1.0);
        let axes = ["x", "y"];
        let number = |index: usize, name: &str| {
            let coordinate = field::coordinate(&fields[index], name, per_metre);
            FilePlace::field(line, index + 1).read(origin, coordinate)
        };
        match self.place {
            Place::Point([x, y]) => Ok([number(x, axes[0])?, number(y, axes[1])?]),
            Place::Centre(columns) | Place::FootOfCorners(columns) => {
                let [left, top, right, bottom] = columns.map(|index| number(index, &self.names[index]));
                let (left, top, right, bottom) = (left?, top?, right?, bottom?);
                let y = match self.place {
                    Place::Centre(_) => 0.5 * (top + bottom),
                    _ => bottom,
                };
                Ok([0.5 * (left + right), y])
            }
            Place::Foot(columns) => {
                let [left, top, width, height] = columns.map(|index| number(index, &self.names[index]));
                Ok([left? + 0.5 * width?, top? + height?])
            }
        }
    }

    #[expect(clippy::float_cmp, reason = "a constant is written with the same digits")]
    fn check_constant(&mut self, fields: &[Cow<'_, str>], line: usize, origin: &str) -> Result<(), FormatError> {
        let Some((index, first)) = &mut self.constant else {
            return Ok(());
        };
        let Ok(number) = fields[*index].parse::<f64>() else {
            return Ok(());
        };
        let known = *first.get_or_insert(number);
        if known == number {
            return Ok(());
        }
        let problem = format!(
            "eight columns are read as those of obsmat.txt ({}), but the fourth, the height, changes from {known} to \
             {number}; if they are others, write their names above the rows: frame, pedestrian, x, y, and any others",
            self.names.join(", ")
        );
        Err(FilePlace::field(line, *index + 1).wrong(origin, problem))
    }

    fn wrong_count(&self, found: usize) -> String {
        let expected = self.names.len();
        let names = first_of(&self.names);
        let advice = match self.separator {
            _ if found == 1 => "; the fields are not separated like those of the first line",
            Separator::Comma if found > expected => "; a comma stands between two fields and is not a decimal point",
            _ => "",
        };
        field_count(expected, found, &names) + advice
    }
}

impl Place {
    fn columns(&self) -> &[usize] {
        match self {
            Self::Point(columns) => columns,
            Self::Centre(columns) | Self::Foot(columns) | Self::FootOfCorners(columns) => columns,
        }
    }
}

/// The header in a comment, as numpy writes it: with all names that are needed.
pub(super) fn in_comment(comment: &str, choice: &ColumnChoice) -> Option<(Header, Vec<String>)> {
    let text = comment.trim_start().trim_start_matches(COMMENT).trim();
    let fields = Separator::of(text).fields(text, 1, "").ok()?;
    let names: Vec<&str> = fields.iter().map(|field| &**field).collect();
    let header = Header::of(&names, choice).ok()?;
    Some((header, names.iter().map(|&name| name.to_owned()).collect()))
}
