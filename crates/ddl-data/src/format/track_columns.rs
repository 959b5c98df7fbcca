//! The columns of text, from a header or a layout, and the observations of its lines.

use std::borrow::Cow;

use ddl_core::{Position, Setting};

use crate::clock::{STAMPS_A_SECOND, TimeUnit};
use crate::format::choice::ColumnChoice;
use crate::format::column_names::{LengthUnit, is_of_time};
use crate::format::comments::{is_comment, names_in_comments};
use crate::format::field::{self, PedestrianField};
use crate::format::header::{Header, TimeColumn, first_of, is_camera};
use crate::format::kind::Format;
use crate::format::layouts::Layout;
use crate::format::place::{FilePlace, Misread};
use crate::format::problem::field_count;
use crate::format::row_filter::{RowFilter, UNTRACKED, are_alike};
use crate::format::rows::TrackRow;
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

/// The columns of a text, and what was found in its rows.
#[derive(Debug)]
pub(super) struct TrackColumns {
    format: Format,
    separator: Separator,
    names: Vec<String>,
    /// The least number of fields: rows and the header may end with separators.
    needed: usize,
    header: Header,
    is_mapped: bool,
    filter: RowFilter,
    /// Columns whose value stays the same, and their values.
    constants: Vec<(usize, Option<String>)>,
    /// Further columns that must hold numbers.
    numbers: Vec<usize>,
    /// Why the first column is read in its unit, if its name does not say so.
    assumed_unit: Option<&'static str>,
    note: Option<&'static str>,
    /// Whether a row has been read.
    has_rows: bool,
    /// Whether a stream has told its notes.
    is_told: bool,
}

impl TrackColumns {
    /// The columns of a text that begins with these comments and this line, and whether the line is their header.
    pub(super) fn of(
        (format, choice): (Format, &ColumnChoice),
        comments: &[&str],
        first: &str,
        line: usize,
    ) -> Result<(Self, bool), Misread> {
        let (columns, is_header) = if let Some(layout) = Layout::of(format) {
            let columns = Self::laid_out(layout, Separator::of_numbers(first), choice);
            (columns.map_err(|problem| FilePlace::line(line).wrong(problem))?, false)
        } else {
            Self::with_header(choice, comments, (first, line))?
        };
        if choice.is_mapped && columns.header.has_unit {
            let (none, pixels) = (Setting::Homography.to("none"), Setting::Unit.to("px"));
            let problem = format!(
                "the columns say that positions are in metres or parts of them, and the homography maps pixels; give \
                 {none}, or {pixels} if they are pixels"
            );
            return Err(FilePlace::line(line).wrong(problem));
        }
        Ok((columns, is_header))
    }

    /// The columns of a table whose header is its first line or a comment.
    fn with_header(
        choice: &ColumnChoice,
        comments: &[&str],
        (first, line): (&str, usize),
    ) -> Result<(Self, bool), Misread> {
        let separator = Separator::of(first);
        let fields = separator.fields(first, line)?;
        if fields.iter().any(|field| field.parse::<f64>().is_ok())
            && let Some(names) = names_in_comments(comments.iter().copied(), fields.len(), choice)
        {
            let count = fields.len() - fields.iter().rev().take_while(|field| field.is_empty()).count();
            let header = Header::of(&names.iter().map(String::as_str).collect::<Vec<_>>(), choice);
            let header = header.map_err(|(_, problem)| FilePlace::line(1).wrong(problem))?;
            if count != names.len() {
                let problem = format!("the comment above names {} columns, this row has {count}", names.len());
                return Err(FilePlace::line(line).wrong(problem));
            }
            return Ok((Self::named(header, names, Separator::of_numbers(first), None, choice), false));
        }
        let names: Vec<&str> = fields.iter().map(|field| &**field).collect();
        let header = Header::of(&names, choice).map_err(|(field, problem)| {
            let place = field.map_or(FilePlace::line(line), |index| FilePlace::field(line, index + 1));
            place.wrong(problem)
        })?;
        let names = names.iter().map(|&name| name.to_owned()).collect();
        Ok((Self::named(header, names, separator, None, choice), true))
    }

    fn named(
        header: Header,
        names: Vec<String>,
        separator: Separator,
        layout: Option<&Layout>,
        choice: &ColumnChoice,
    ) -> Self {
        let filter = RowFilter::of(&header, layout, choice, &names);
        let constants = header.groups.iter().map(|&index| (index, None)).collect();
        let unnamed = names.iter().rev().take_while(|name| name.is_empty()).count();
        Self {
            format: layout.map_or(Format::Table, |layout| layout.format),
            separator,
            needed: names.len() - unnamed,
            names,
            header,
            is_mapped: choice.is_mapped,
            filter,
            constants,
            numbers: Vec::new(),
            assumed_unit: None,
            note: None,
            has_rows: false,
            is_told: false,
        }
    }

    fn laid_out(layout: &Layout, separator: Separator, choice: &ColumnChoice) -> Result<Self, String> {
        if let Some((_, name)) = choice.roles.first() {
            let problem = "there is no header, so no column is called";
            return Err(format!("{problem} {name:?}; write one above the rows"));
        }
        let names: Vec<String> = layout.names.split(' ').map(str::to_owned).collect();
        let is_class = |index: usize| layout.class.is_some_and(|(class, _)| class == index);
        let of_row = [&[layout.frame, layout.pedestrian], layout.place.columns()].concat();
        let numbers = (0..names.len()).filter(|index| !of_row.contains(index) && !is_class(*index));
        let is_as_usual = choice.unit.is_none() && choice.keep.is_none();
        let mut remarks = Vec::new();
        if !is_as_usual {
            let asked = "with the unit and the rows asked for";
            remarks.push(format!("read as {}, {asked}", layout.format));
        }
        if layout.format == Format::SocialGan && separator != Separator::Blanks {
            remarks.push(UNNAMED.to_owned());
        }
        let header = Header::of_layout(layout, choice, remarks)?;
        Ok(Self {
            numbers: numbers.collect(),
            note: layout.note.filter(|_| is_as_usual),
            ..Self::named(header, names, separator, Some(layout), choice)
        })
    }

    /// The observation of a line of a stream; `None` where it is left out.
    pub(super) fn row_of_line(&mut self, text: &str, line: usize) -> Result<Option<TrackRow>, Misread> {
        let before = (self.header.time, self.assumed_unit);
        let fields = self.separator.fields(text, line)?;
        if !self.is_comment(text, &fields) {
            self.look_at(fields.get(self.header.frame).map(|field| &**field));
        }
        self.row_of(text, &fields, line).map_err(|wrong| {
            (self.header.time, self.assumed_unit) = before;
            wrong.and(&self.words_in(&fields))
        })
    }

    /// Whether a line after the first row is a comment. A row may begin with the sign, in the name of a pedestrian.
    fn is_comment(&self, text: &str, fields: &[Cow<'_, str>]) -> bool {
        let is_time = |time: &Cow<'_, str>| self.is_number(time) || field::unit_of(time) == TimeUnit::Dates;
        is_comment(text) && !(self.is_whole(fields) && fields.get(self.header.frame).is_some_and(is_time))
    }

    fn is_number(&self, field: &str) -> bool {
        self.separator.with_point(field).parse::<f64>().is_ok()
    }

    /// Whether a line has the fields of a row; those beyond are empty.
    fn is_whole(&self, fields: &[Cow<'_, str>]) -> bool {
        let mut beyond = fields.iter().skip(self.names.len());
        fields.len() >= self.needed && (self.format == Format::Kitti || beyond.all(|field| field.is_empty()))
    }

    /// The observations of all rows of a file, each with its line. A fraction in the column of the frame shows seconds;
    /// then the rows before it are read again.
    pub(super) fn all_rows<'a>(
        &mut self,
        rows: impl Iterator<Item = (usize, &'a str)> + Clone,
        most: usize,
    ) -> Result<Vec<TrackRow>, Misread> {
        if self.header.time == TimeColumn::Time {
            let time = rows.clone().find_map(|(line, text)| {
                let fields = self.separator.fields(text, line).ok()?;
                let is_row = !self.is_comment(text, &fields);
                fields.into_iter().nth(self.header.frame).filter(|_| is_row)
            });
            self.look_at(time.map(Cow::into_owned).as_deref());
        }
        let before = (self.filter.clone(), self.constants.clone());
        if let Some(read) = self.rows_in_known_unit(rows.clone(), most)? {
            return Ok(read);
        }
        (self.filter, self.constants) = before;
        Ok(self.rows_in_known_unit(rows, most)?.unwrap_or_default())
    }

    /// `None` as soon as a row shows that the frames are seconds.
    fn rows_in_known_unit<'a>(
        &mut self,
        rows: impl Iterator<Item = (usize, &'a str)>,
        most: usize,
    ) -> Result<Option<Vec<TrackRow>>, Misread> {
        let (mut read, mut fields) = (Vec::with_capacity(most), Vec::new());
        for (line, text) in rows {
            self.separator.split(text, line, &mut fields)?;
            let time = fields.get(self.header.frame).filter(|_| self.header.time == TimeColumn::Frame);
            let has_fraction = |time: &&Cow<'_, str>| field::has_fraction(&self.separator.with_point(time));
            if let Some(time) = time.filter(|time| has_fraction(time) && !self.is_comment(text, &fields)) {
                self.look_at(Some(time));
                return Ok(None);
            }
            let row = self.row_of(text, &fields, line);
            read.extend(row.map_err(|wrong| wrong.and(&self.words_in(&fields)))?);
        }
        Ok(Some(read))
    }

    /// Makes these the columns of a stream. Without a header they are those of `social-gan`, which is told. Further
    /// columns may change at any time, but those of cameras must be named scene.
    pub(super) fn begin_stream(&mut self, line: usize) -> Result<(), Misread> {
        if self.format == Format::SocialGan && self.separator == Separator::Blanks {
            self.header.remarks.push(UNNAMED.to_owned());
        }
        if self.format != Format::Table {
            return Ok(());
        }
        self.constants.clear();
        let is_camera = |index: &&usize| is_camera(&self.names[**index]) && self.header.keep != Some(**index);
        let Some(index) = self.header.groups.iter().find(is_camera) else {
            return Ok(());
        };
        let name = field::quoted(&self.names[*index]);
        let keep = Setting::Keep.to(format!("{name}=VALUE"));
        let problem = format!("rename the column {name} scene, or give {keep} for one of them");
        Err(FilePlace::field(line, index + 1).wrong(problem))
    }

    /// What a stream has not told yet.
    pub(super) fn new_notes(&mut self) -> Vec<String> {
        let mut notes = if self.is_told { Vec::new() } else { self.notes() };
        self.is_told = true;
        notes.extend(self.filter.news());
        notes
    }

    /// What a reader of a whole file should know.
    pub(super) fn notes_of_file(&self) -> Vec<String> {
        let mut notes = self.notes();
        notes.extend(self.filter.left_out());
        notes.extend(self.filter.classes_read());
        notes
    }

    /// Frames a second of all files of the format, if it is known.
    pub(super) fn rate(&self) -> Option<f64> {
        Layout::of(self.format)?.rate
    }

    /// The rows that were left out.
    pub(super) fn left_out(&self) -> Option<String> {
        self.filter.left_out()
    }

    /// What a reader should know of the columns.
    fn notes(&self) -> Vec<String> {
        let mut notes: Vec<String> = self.note.into_iter().map(str::to_owned).collect();
        notes.extend(self.header.remarks.iter().cloned());
        notes.extend(self.assumed_unit.map(str::to_owned));
        match &self.quoted(self.header.unread.iter().copied())[..] {
            [] => {}
            [name] => notes.push(format!("the column {name} is not read")),
            names => notes.push(format!("the columns {} are not read", first_of(names))),
        }
        match self.header.per_metre {
            None if self.is_mapped => {}
            None => notes.push(note_on_pixels()),
            Some(per_metre) if self.note.is_none() => {
                notes.extend(LengthUnit::words(per_metre).map(|unit| format!("the positions are in {unit}")));
            }
            Some(_) => {}
        }
        notes
    }

    /// Finds out what the column of the time counts from a time: a first one, or one with a fraction.
    fn look_at(&mut self, time: Option<&str>) {
        let time = time.map(|time| self.separator.with_point(time));
        let time = time.as_deref();
        let unit = match self.header.time {
            TimeColumn::Known(unit) => unit,
            TimeColumn::Time => time.map(field::unit_of),
            TimeColumn::Frame => time.is_some_and(field::has_fraction).then_some(TimeUnit::Seconds),
        };
        self.assumed_unit = match self.header.time {
            TimeColumn::Frame if unit.is_some() => Some(FRACTIONS),
            TimeColumn::Time => match unit {
                Some(TimeUnit::Seconds) if time.is_some_and(|time| !time.contains('.')) => Some(WHOLE_TIMES),
                Some(TimeUnit::Milliseconds) => Some("the times have 13 digits: they are read as milliseconds"),
                Some(TimeUnit::Microseconds) => Some("the times have 16 digits: they are read as microseconds"),
                Some(TimeUnit::Nanoseconds) => Some("the times have 19 digits: they are read as nanoseconds"),
                _ => self.assumed_unit,
            },
            _ => self.assumed_unit,
        };
        self.header.time = TimeColumn::Known(unit);
    }

    /// The observation of a line; `None` where it is left out.
    fn row_of(&mut self, text: &str, fields: &[Cow<'_, str>], line: usize) -> Result<Option<TrackRow>, Misread> {
        if self.is_comment(text, fields) {
            return Ok(None);
        }
        if !self.is_whole(fields) {
            return Err(FilePlace::line(line).wrong(self.wrong_count(fields.len())));
        }
        let place = |index: usize| FilePlace::field(line, index + 1);
        let counts = self.filter.counts(fields, self.header.place.columns());
        if !counts.map_err(|(index, problem)| place(index).wrong(problem))? {
            return Ok(None);
        }
        let unit = match self.header.time {
            TimeColumn::Known(unit) => unit,
            TimeColumn::Frame | TimeColumn::Time => None,
        };
        let time = self.separator.with_point(&fields[self.header.frame]);
        let mut frame = place(self.header.frame).read(field::frame(&time, "frame", unit))?;
        let is_whole = frame % STAMPS_A_SECOND == 0;
        self.assumed_unit = self.assumed_unit.filter(|unit| is_whole || *unit != WHOLE_TIMES);
        if let Some((index, name, a_second)) = self.header.rest {
            let rest = place(index).read(field::integer(&fields[index], name))?;
            if !(0..a_second).contains(&rest) {
                return Err(place(index).wrong(format!("{rest} {name} are no part of a second")));
            }
            frame += rest * STAMPS_A_SECOND / a_second;
        }
        let name = &fields[self.header.pedestrian];
        // Only `12,0` is a number; `1,000` and `3,12` are names.
        let is_float = name.ends_with(",0") || name.ends_with(",00");
        let number = self.separator.with_point(name);
        // Pedestrians are floats in this format, never words.
        let pedestrian = if self.format == Format::Obsmat {
            field::integer(&number, "pedestrian").map(|number| PedestrianField::Number(number, None))
        } else {
            field::pedestrian(if is_float { &number } else { name }, "pedestrian")
        };
        let pedestrian = place(self.header.pedestrian).read(pedestrian)?;
        if pedestrian == PedestrianField::Number(-1, None) {
            self.filter.leave_out(UNTRACKED.to_owned());
            return Ok(None);
        }
        let position = self.position(fields, line)?;
        // Columns that are not used. Checking that they are numbers confirms the order of the columns.
        for &index in &self.numbers {
            let number = self.separator.with_point(&fields[index]);
            place(index).read(field::number(&number, &self.names[index]))?;
        }
        self.check_constants(fields, line)?;
        self.look_at_first(fields, line)?;
        let scene = self.header.scene.map(|index| {
            let scene = SceneName::new(&fields[index]).map_err(|error| error.to_string());
            place(index).read(scene)
        });
        Ok(Some(TrackRow {
            scene: scene.transpose()?,
            frame,
            unit,
            pedestrian,
            position,
            place: FilePlace::line(line),
        }))
    }

    /// What else a line may be that is read as a row.
    fn words_in(&self, fields: &[Cow<'_, str>]) -> String {
        if fields.iter().eq(&self.names) {
            "; the line repeats the names of the columns: delete it, or make a file of each part".to_owned()
        } else if self.is_whole(fields) && !fields.iter().any(|field| self.is_number(field)) {
            let unit = Setting::Unit;
            format!("; the line holds no number: delete it if it names units ({unit} gives that of the positions)")
        } else {
            String::new()
        }
    }

    fn position(&self, fields: &[Cow<'_, str>], line: usize) -> Result<Position, Misread> {
        let per_metre = self.header.per_metre.unwrap_or(1.0);
        let number = |index: usize| {
            let number = self.separator.with_point(&fields[index]);
            let coordinate = field::coordinate(&number, &self.names[index], per_metre);
            FilePlace::field(line, index + 1).read(coordinate)
        };
        self.header.place.position(number, line)
    }

    /// Checks that each constant column keeps its first value; empty fields do not count.
    fn check_constants(&mut self, fields: &[Cow<'_, str>], line: usize) -> Result<(), Misread> {
        for (index, first) in &mut self.constants {
            let found = &*fields[*index];
            if found.is_empty() {
                continue;
            }
            let known = &*first.get_or_insert_with(|| found.to_owned());
            if are_alike(known, found) {
                continue;
            }
            let [known, found, name] = [known, found, &self.names[*index]].map(field::quoted);
            let problem = if self.format == Format::Obsmat {
                format!(
                    "eight columns are read as those of obsmat.txt ({}), but the fourth, the height, changes from \
                     {known} to {found}; if they are others, write their names above the rows: frame, pedestrian, x, \
                     y, and any others",
                    self.names.join(", ")
                )
            } else {
                let keep = Setting::Keep.to(format!("{name}={known}"));
                format!("{name} changes from {known} to {found}: a file holds one recording; {keep} reads one of them")
            };
            return Err(FilePlace::field(line, *index + 1).wrong(problem));
        }
        Ok(())
    }

    /// Looks in the first row for columns of words, and for the size of a person, without which KITTI has no ground.
    fn look_at_first(&mut self, fields: &[Cow<'_, str>], line: usize) -> Result<(), Misread> {
        if std::mem::replace(&mut self.has_rows, true) {
            return Ok(());
        }
        self.header.name_words_first(fields, &self.names);
        let is_size = |field: &Cow<'_, str>| field.parse().is_ok_and(|size: f64| size > 0.0 && size < 3.0);
        if self.format != Format::Kitti || !self.filter.is_of_people() || fields[10..13].iter().all(is_size) {
            return Ok(());
        }
        let problem = "the height, width and length (columns 11 to 13) are not those of a person: are these tracks in \
                       the picture alone, or positions before sizes? Write the names of the columns above the rows";
        Err(FilePlace::field(line, 11).wrong(problem))
    }

    /// What else may be done about two rows of a pedestrian in one frame: they may be of several recordings.
    pub(super) fn advice_on_same(&self, rows: [&str; 2]) -> String {
        let [first, again] = rows.map(|row| self.separator.fields(row, 1).unwrap_or_default());
        // A number with a fraction is a measurement, not the name of a recording.
        let tells = |index: &usize| match [first.get(*index), again.get(*index)] {
            _ if is_of_time(&self.names[*index]) => false,
            [Some(first), Some(again)] => first != again && ![first, again].iter().any(|it| it.contains('.')),
            _ => false,
        };
        let apart: Vec<usize> = self.header.unread.iter().copied().filter(tells).collect();
        let of_first = apart.first().map(|&index| [&first[index], &again[index]]);
        let value = of_first.and_then(|values| values.into_iter().find(|value| !value.is_empty()));
        value.map_or_else(String::new, |value| {
            let (names, value) = (self.quoted(apart.iter().copied()), field::quoted(value));
            let (all, name) = (first_of(&names), &names[0]);
            let keep = Setting::Keep.to(format!("{name}={value}"));
            format!("; if recordings are told apart by {all}, read one of them ({keep})")
        })
    }

    fn quoted(&self, columns: impl Iterator<Item = usize>) -> Vec<String> {
        columns.map(|index| field::quoted(&self.names[index])).collect()
    }

    fn wrong_count(&self, found: usize) -> String {
        let expected = self.names.len();
        let names = first_of(&self.quoted(0..expected));
        let advice = match self.separator {
            Separator::Blanks if self.format == Format::SocialGan && found == 3 => OF_ONE,
            _ if found == 1 => "; the fields are not separated like those of the first line",
            _ if found == expected + 1 && self.format == Format::Table => {
                "; does each row begin with a name that the header lacks?"
            }
            Separator::Blanks if found > expected => "; write the names of the columns above the rows",
            Separator::Comma if found > expected => "; a comma stands between two fields and is not a decimal point",
            _ => "",
        };
        field_count(expected, found, &names) + advice
    }
}
