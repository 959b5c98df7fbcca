//! The columns of text, from a header or a layout, and what a row holds in each.

use std::borrow::Cow;

use ddl_core::{PedestrianName, Position, Setting};

use crate::clock::{STAMPS_A_SECOND, TimeUnit};
use crate::format::choice::ColumnChoice;
use crate::format::column_names::{LengthUnit, is_of_time};
use crate::format::comments::{is_comment, names_in_comments};
use crate::format::fault::{Fault, FormatError};
use crate::format::field::{self, are_alike};
use crate::format::header::{ColumnRoles, TimeColumn, first_of, is_camera};
use crate::format::kind::Format;
use crate::format::layouts::FileLayout;
use crate::format::quoted::quoted;
use crate::format::separator::Separator;
use crate::scene_name::SceneName;

const FRACTIONS: &str = "the column frame has fractions: it is read as seconds";
const WHOLE_TIMES: &str = "the times are whole numbers: they are read as seconds; call the column frame if they count \
    frames, or time_ms, time_us or time_ns";
const UNNAMED: &str = "the rows have no header: they are read as frame, pedestrian, x, y";
const OF_ONE: &str = "; files of one pedestrian each, with y, x and frame (Grand Central), become one by: for f in \
    *.txt; do xargs -n3 < $f | awk -v p=${f%.txt} '{print $3, p, $2, $1}'; done > all.tracks";

/// What the reader of a file in pixels should know.
pub(super) fn note_on_pixels() -> String {
    format!("the positions are in pixels, and forecasts need metres: give {}", Setting::Homography)
}

/// What times count, and why, if their column does not say it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct TimeReading {
    /// `None` for frames.
    pub(super) unit: Option<TimeUnit>,
    pub(super) assumed: Option<&'static str>,
}

impl TimeReading {
    /// Frames with fractions.
    pub(super) const SECONDS: Self = Self { unit: Some(TimeUnit::Seconds), assumed: Some(FRACTIONS) };
}

/// The columns of a text. They do not change while its rows are read.
#[derive(Debug)]
pub(super) struct TrackColumns {
    format: Format,
    pub(super) separator: Separator,
    pub(super) names: Vec<String>,
    /// The least number of fields: rows and the header may end with separators.
    needed: usize,
    pub(super) roles: ColumnRoles,
    is_mapped: bool,
    note: Option<&'static str>,
}

impl TrackColumns {
    /// The columns of a text that begins with these comments and this line, and whether the line is their header.
    pub(super) fn of(
        (format, choice): (Format, &ColumnChoice),
        comments: &[&str],
        first: &str,
        line: usize,
    ) -> Result<(Self, bool), FormatError> {
        let here = |fault: Fault| fault.in_line("", line);
        let separator = Separator::of(first);
        let (columns, is_header) = if let Some(layout) = FileLayout::of(format) {
            (Self::laid_out(layout, Separator::of_numbers(first), choice).map_err(here)?, false)
        } else {
            let fields = separator.fields(first).map_err(here)?;
            let is_number = |field: &Cow<'_, str>| field.parse::<f64>().is_ok();
            let in_comments = || names_in_comments(comments.iter().copied(), fields.len(), choice);
            if let Some(names) = fields.iter().any(is_number).then(in_comments).flatten() {
                let columns = Self::named(names, Separator::of_numbers(first), choice);
                let columns = columns.map_err(|fault| Fault::from(fault.problem).in_line("", 1))?;
                let count = fields.len() - fields.iter().rev().take_while(|field| field.is_empty()).count();
                if count != columns.names.len() {
                    let named = columns.names.len();
                    let problem = format!("the comment above names {named} columns, this row has {count}");
                    return Err(here(problem.into()));
                }
                (columns, false)
            } else {
                (Self::named(fields.into_iter().map(Cow::into_owned).collect(), separator, choice).map_err(here)?, true)
            }
        };
        if choice.is_mapped && columns.roles.has_unit {
            let (none, pixels) = (Setting::Homography.to("none"), Setting::Unit.to("px"));
            let advice = format!("give {none}, or {pixels} if they are pixels");
            let problem =
                "the columns say that positions are in metres or parts of them, and the homography maps pixels";
            return Err(here(format!("{problem}; {advice}").into()));
        }
        Ok((columns, is_header))
    }

    /// The columns of a table with these names.
    fn named(names: Vec<String>, separator: Separator, choice: &ColumnChoice) -> Result<Self, Fault> {
        let roles = ColumnRoles::of_names(&names.iter().map(String::as_str).collect::<Vec<_>>(), choice)?;
        let needed = names.len() - names.iter().rev().take_while(|name| name.is_empty()).count();
        let is_mapped = choice.is_mapped;
        Ok(Self { format: Format::Table, separator, names, needed, roles, is_mapped, note: None })
    }

    fn laid_out(layout: &FileLayout, separator: Separator, choice: &ColumnChoice) -> Result<Self, Fault> {
        let roles = ColumnRoles::of_layout(layout, choice)?;
        let names: Vec<String> = layout.names.split(' ').map(str::to_owned).collect();
        let (needed, is_mapped, format) = (names.len(), choice.is_mapped, layout.format);
        let note = layout.note.filter(|_| roles.remarks.is_empty());
        Ok(Self { format, separator, names, needed, roles, is_mapped, note })
    }

    /// Whether the columns are those of a header.
    pub(super) fn is_table(&self) -> bool {
        self.format == Format::Table
    }

    /// Refuses a column of cameras in a stream, unless it chooses one of them.
    pub(super) fn refuse_cameras(&self) -> Result<(), Fault> {
        let is_kept = |index: usize| self.roles.keep.as_ref().is_some_and(|(kept, _)| *kept == index);
        let mut cameras = self.roles.constants.iter().filter(|&&index| is_camera(&self.names[index]));
        let Some(&index) = cameras.find(|&&index| self.is_table() && !is_kept(index)) else { return Ok(()) };
        let name = quoted(&self.names[index]);
        let keep = Setting::Keep.to(format!("{name}=VALUE"));
        Err(Fault::at(index, format!("rename the column {name} scene, or give {keep} for one of them")))
    }

    /// Whether a line after the first row is a comment. A row may begin with the sign, in the name of a pedestrian.
    pub(super) fn is_comment(&self, text: &str, fields: &[Cow<'_, str>]) -> bool {
        let is_time = |time: &Cow<'_, str>| self.is_number(time) || field::unit_of(time) == TimeUnit::Dates;
        is_comment(text) && !(self.is_whole(fields) && fields.get(self.roles.frame).is_some_and(is_time))
    }

    fn is_number(&self, field: &str) -> bool {
        self.separator.with_point(field).parse::<f64>().is_ok()
    }

    /// Whether a line has the fields of a row; those beyond are empty.
    fn is_whole(&self, fields: &[Cow<'_, str>]) -> bool {
        let mut beyond = fields.iter().skip(self.names.len());
        fields.len() >= self.needed && (self.format == Format::Kitti || beyond.all(|field| field.is_empty()))
    }

    pub(super) fn check_count(&self, fields: &[Cow<'_, str>]) -> Result<(), Fault> {
        if self.is_whole(fields) {
            return Ok(());
        }
        let (expected, found) = (self.names.len(), fields.len());
        let names = first_of(&self.quoted(0..expected));
        let advice = match self.separator {
            Separator::Blanks if self.format == Format::SocialGan && found == 3 => OF_ONE,
            _ if found == 1 => "; the fields are not separated like those of the first line",
            _ if found == expected + 1 && self.is_table() => "; does each row begin with a name that the header lacks?",
            Separator::Blanks if found > expected => "; write the names of the columns above the rows",
            Separator::Comma if found > expected => "; a comma stands between two fields and is not a decimal point",
            _ => "",
        };
        Err(format!("{found} fields where {expected} are expected ({names}){advice}").into())
    }

    /// Whether a fraction in the column of the frame shows that it holds seconds.
    pub(super) fn has_fraction(&self, fields: &[Cow<'_, str>]) -> bool {
        fields.get(self.roles.frame).is_some_and(|time| field::has_fraction(&self.separator.with_point(time)))
    }

    /// What the column of the time counts, as a row with these fields shows, if it is the first one.
    pub(super) fn shown_by(&self, fields: &[Cow<'_, str>]) -> TimeReading {
        let time = || Some(self.separator.with_point(fields.get(self.roles.frame)?));
        let (unit, assumed) = match self.roles.time {
            TimeColumn::Known(unit) => (unit, None),
            TimeColumn::Frame if self.has_fraction(fields) => return TimeReading::SECONDS,
            TimeColumn::Frame => (None, None),
            TimeColumn::Time => {
                let unit = time().map(|time| field::unit_of(&time));
                let assumed = match unit {
                    Some(TimeUnit::Seconds) if time().is_some_and(|time| !time.contains('.')) => Some(WHOLE_TIMES),
                    Some(TimeUnit::Milliseconds) => Some("the times have 13 digits: they are read as milliseconds"),
                    Some(TimeUnit::Microseconds) => Some("the times have 16 digits: they are read as microseconds"),
                    Some(TimeUnit::Nanoseconds) => Some("the times have 19 digits: they are read as nanoseconds"),
                    _ => None,
                };
                (unit, assumed)
            }
        };
        TimeReading { unit, assumed }
    }

    fn number<'a>(&self, fields: &'a [Cow<'_, str>], index: usize) -> Cow<'a, str> {
        self.separator.with_point(&fields[index])
    }

    /// The frame number or the time in microseconds. A time with a fraction shows that times are seconds.
    pub(super) fn frame(&self, fields: &[Cow<'_, str>], time: &mut TimeReading) -> Result<i64, Fault> {
        let column = self.roles.frame;
        let frame = field::frame(&self.number(fields, column), "frame", time.unit);
        let frame = frame.map_err(|problem| Fault::at(column, problem))?;
        if time.assumed == Some(WHOLE_TIMES) && frame % STAMPS_A_SECOND != 0 {
            time.assumed = None;
        }
        let Some((index, name, a_second)) = self.roles.rest else { return Ok(frame) };
        let rest = field::integer(&fields[index], name).map_err(|problem| Fault::at(index, problem))?;
        if !(0..a_second).contains(&rest) {
            return Err(Fault::at(index, format!("{rest} {name} are no part of a second")));
        }
        Ok(frame + rest * STAMPS_A_SECOND / a_second)
    }

    pub(super) fn pedestrian(&self, fields: &[Cow<'_, str>]) -> Result<PedestrianName, Fault> {
        let (index, name) = (self.roles.pedestrian, &fields[self.roles.pedestrian]);
        let number = self.separator.with_point(name);
        // Only `12,0` is a number; `1,000` and `3,12` are names.
        let is_float = name.ends_with(",0") || name.ends_with(",00");
        // Pedestrians are floats in this format, never words.
        let pedestrian = if self.format == Format::Obsmat {
            field::integer(&number, "pedestrian").map(PedestrianName::Number)
        } else {
            field::pedestrian(if is_float { &number } else { name }, "pedestrian")
        };
        pedestrian.map_err(|problem| Fault::at(index, problem))
    }

    pub(super) fn position(&self, fields: &[Cow<'_, str>]) -> Result<Position, Fault> {
        let per_metre = self.roles.per_metre.unwrap_or(1.0);
        self.roles.position.position(|index| {
            let coordinate = field::coordinate(&self.number(fields, index), &self.names[index], per_metre);
            coordinate.map_err(|problem| Fault::at(index, problem))
        })
    }

    /// Checks the columns of numbers that are not used, which confirms the order of the columns.
    pub(super) fn check_numbers(&self, fields: &[Cow<'_, str>]) -> Result<(), Fault> {
        self.roles.numbers.iter().try_for_each(|&index| {
            field::number(&self.number(fields, index), &self.names[index]).map_err(|problem| Fault::at(index, problem))
        })
    }

    /// Checks that a constant column keeps its first value.
    pub(super) fn check_constant(&self, index: usize, known: &str, found: &str) -> Result<(), Fault> {
        if are_alike(known, found) {
            return Ok(());
        }
        let [known, found, name] = [known, found, &self.names[index]].map(quoted);
        Err(Fault::at(
            index,
            if self.format == Format::Obsmat {
                format!(
                    "eight columns are read as those of obsmat.txt ({}), but the fourth, the height, changes from \
                     {known} to {found}; if they are others, write their names above the rows: frame, pedestrian, x, \
                     y, and any others",
                    self.names.join(", ")
                )
            } else {
                let keep = Setting::Keep.to(format!("{name}={known}"));
                format!("{name} changes from {known} to {found}: a file holds one recording; {keep} reads one of them")
            },
        ))
    }

    /// Checks in the first row of KITTI that there is the size of a person, without which it has no ground.
    pub(super) fn check_size(&self, fields: &[Cow<'_, str>]) -> Result<(), Fault> {
        let is_size = |field: &Cow<'_, str>| field.parse().is_ok_and(|size: f64| size > 0.0 && size < 3.0);
        let is_kitti = self.format == Format::Kitti && self.roles.class.is_some();
        if !is_kitti || fields[10..13].iter().all(is_size) {
            return Ok(());
        }
        let problem = "the height, width and length (columns 11 to 13) are not those of a person: are these tracks in \
                       the picture alone, or positions before sizes? Write the names of the columns above the rows";
        Err(Fault::at(10, problem))
    }

    pub(super) fn scene(&self, fields: &[Cow<'_, str>]) -> Result<Option<SceneName>, Fault> {
        let scene = self
            .roles
            .scene
            .map(|index| SceneName::new(&fields[index]).map_err(|error| Fault::at(index, error.to_string())));
        scene.transpose()
    }

    /// The fault with advice on what else a line may be that is read as a row.
    pub(super) fn with_advice(&self, fault: Fault, fields: &[Cow<'_, str>]) -> Fault {
        if fields.iter().eq(&self.names) {
            fault.and("; the line repeats the names of the columns: delete it, or make a file of each part")
        } else if self.is_whole(fields) && !fields.iter().any(|field| self.is_number(field)) {
            let advice = format!("delete it if it names units ({} gives that of the positions)", Setting::Unit);
            fault.and(format!("; the line holds no number: {advice}"))
        } else {
            fault
        }
    }

    /// Frames a second of all files of the format, if it is known.
    pub(super) fn rate(&self) -> Option<f64> {
        FileLayout::of(self.format)?.rate
    }

    /// What a reader should know of the columns: why times are read as they are (`assumed`), what is not read, and what
    /// a stream takes for granted.
    pub(super) fn notes(&self, assumed: Option<&str>, unread: &[usize], is_stream: bool) -> Vec<String> {
        let mut notes: Vec<String> = self.note.into_iter().map(str::to_owned).collect();
        notes.extend(self.roles.remarks.iter().cloned());
        if self.format == Format::SocialGan && (is_stream || self.separator != Separator::Blanks) {
            notes.push(UNNAMED.to_owned());
        }
        notes.extend(assumed.map(str::to_owned));
        match &self.quoted(unread.iter().copied())[..] {
            [] => {}
            [name] => notes.push(format!("the column {name} is not read")),
            names => notes.push(format!("the columns {} are not read", first_of(names))),
        }
        match self.roles.per_metre {
            None if self.is_mapped => {}
            None => notes.push(note_on_pixels()),
            Some(per_metre) if self.note.is_none() => {
                notes.extend(LengthUnit::name_of(per_metre).map(|unit| format!("the positions are in {unit}")));
            }
            Some(_) => {}
        }
        notes
    }

    /// What else may be done about two rows of a pedestrian in one frame: they may be of several recordings.
    pub(super) fn advice_on_same(&self, unread: &[usize], rows: [&str; 2]) -> String {
        let [first, again] = rows.map(|row| self.separator.fields(row).unwrap_or_default());
        // A number with a fraction is a measurement, not the name of a recording.
        let tells = |index: &usize| match (first.get(*index), again.get(*index)) {
            (Some(first), Some(again)) if !is_of_time(&self.names[*index]) => {
                first != again && ![first, again].iter().any(|it| it.contains('.'))
            }
            _ => false,
        };
        let apart: Vec<usize> = unread.iter().copied().filter(tells).collect();
        let of_first = apart.first().map(|&index| [&first[index], &again[index]]);
        let value = of_first.and_then(|values| values.into_iter().find(|value| !value.is_empty()));
        value.map_or_else(String::new, |value| {
            let names = self.quoted(apart.iter().copied());
            let keep = Setting::Keep.to(format!("{}={}", names[0], quoted(value)));
            format!("; if recordings are told apart by {}, read one of them ({keep})", first_of(&names))
        })
    }

    fn quoted(&self, columns: impl Iterator<Item = usize>) -> Vec<String> {
        columns.map(|index| quoted(&self.names[index])).collect()
    }
}
