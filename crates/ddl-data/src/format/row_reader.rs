//! Reads the rows of a text. Its columns stay as they are; what rows have shown so far is kept here.

use std::borrow::Cow;

use ddl_core::PedestrianName;

use crate::format::fault::{Fault, FilePlace, FormatError};
use crate::format::header::TimeColumn;
use crate::format::row_filter::{RowFilter, UNTRACKED};
use crate::format::rows::TrackRow;
use crate::format::track_columns::{TimeReading, TrackColumns};

/// The columns of a text, and what its rows have shown.
#[derive(Debug)]
pub(super) struct RowReader {
    pub(super) columns: TrackColumns,
    /// `None` until a row shows it.
    time: Option<TimeReading>,
    pub(super) filter: RowFilter,
    /// Columns whose value stays the same, and their values.
    constants: Vec<(usize, Option<String>)>,
    /// The columns that are not read, in the order of messages; `None` before the first row.
    unread: Option<Vec<usize>>,
    is_stream: bool,
    /// Whether a stream has told its notes.
    is_told: bool,
}

impl RowReader {
    fn new(columns: TrackColumns, time: Option<TimeReading>) -> Self {
        Self {
            time,
            filter: RowFilter::default(),
            constants: columns.roles.constants.iter().map(|&index| (index, None)).collect(),
            unread: None,
            is_stream: false,
            is_told: false,
            columns,
        }
    }

    /// The observations of all rows of a file, each with its line. A fraction in the column of the frame shows seconds;
    /// then the rows before it are read again. `most` is their number, at most.
    pub(super) fn of_file<'a>(
        columns: TrackColumns,
        lines: impl Iterator<Item = (usize, &'a str)> + Clone,
        most: usize,
    ) -> Result<(Self, Vec<TrackRow>), FormatError> {
        let time = match columns.roles.time {
            TimeColumn::Frame => None,
            TimeColumn::Known(_) => Some(columns.shown_by(&[])),
            TimeColumn::Time => {
                let mut rows = lines.clone().filter_map(|(_, text)| {
                    let fields = columns.separator.fields(text).ok()?;
                    let is_row = !columns.is_comment(text, &fields) && fields.len() > columns.roles.frame;
                    is_row.then_some(fields)
                });
                Some(columns.shown_by(&rows.next().unwrap_or_default()))
            }
        };
        let mut reader = Self::new(columns, time);
        let mut rows = reader.rows(lines.clone(), most)?;
        if rows.is_none() {
            reader = Self::new(reader.columns, Some(TimeReading::SECONDS));
            rows = reader.rows(lines, most)?;
        }
        Ok((reader, rows.unwrap_or_default()))
    }

    /// `None` as soon as a row shows that the frames are seconds.
    fn rows<'a>(
        &mut self,
        lines: impl Iterator<Item = (usize, &'a str)>,
        most: usize,
    ) -> Result<Option<Vec<TrackRow>>, FormatError> {
        let (mut read, mut fields) = (Vec::with_capacity(most), Vec::new());
        let mut time = self.time.unwrap_or_default();
        for (line, text) in lines {
            self.columns.separator.split(text, &mut fields).map_err(|fault| fault.in_line("", line))?;
            if self.columns.is_comment(text, &fields) {
                continue;
            }
            if self.time.is_none() && self.columns.has_fraction(&fields) {
                return Ok(None);
            }
            let row = self.row(&fields, line, &mut time);
            read.extend(row.map_err(|fault| self.columns.with_advice(fault, &fields).in_line("", line))?);
        }
        self.time = Some(time);
        Ok(Some(read))
    }

    /// A reader of a stream. Further columns may change at any time, but those of cameras must be named scene.
    pub(super) fn of_stream(columns: TrackColumns) -> Result<Self, Fault> {
        columns.refuse_cameras()?;
        let mut reader = Self { is_stream: true, ..Self::new(columns, None) };
        reader.constants.retain(|_| !reader.columns.is_table());
        Ok(reader)
    }

    /// The observation of a line of a stream; `None` where it is left out. After an error nothing has been shown.
    pub(super) fn row_of_line(&mut self, text: &str, line: usize) -> Result<Option<TrackRow>, Fault> {
        let fields = self.columns.separator.fields(text)?;
        if self.columns.is_comment(text, &fields) {
            return Ok(None);
        }
        let mut time = self.time.unwrap_or_else(|| self.columns.shown_by(&fields));
        let row = self.row(&fields, line, &mut time).map_err(|fault| self.columns.with_advice(fault, &fields))?;
        self.time = Some(time);
        Ok(row)
    }

    /// The observation of a row; `None` where it is left out.
    fn row(&mut self, fields: &[Cow<'_, str>], line: usize, time: &mut TimeReading) -> Result<Option<TrackRow>, Fault> {
        let columns = &self.columns;
        columns.check_count(fields)?;
        if !self.filter.counts(columns, fields)? {
            return Ok(None);
        }
        let frame = columns.frame(fields, time)?;
        let pedestrian = columns.pedestrian(fields)?;
        if pedestrian == PedestrianName::Number(-1) {
            self.filter.leave_out(UNTRACKED.to_owned());
            return Ok(None);
        }
        let position = columns.position(fields)?;
        columns.check_numbers(fields)?;
        for (index, first) in &mut self.constants {
            // Empty fields do not count.
            let found = &*fields[*index];
            if !found.is_empty() {
                columns.check_constant(*index, first.get_or_insert_with(|| found.to_owned()), found)?;
            }
        }
        if self.unread.is_none() {
            self.unread = Some(columns.roles.unread_of_first(fields, &columns.names));
            columns.check_size(fields)?;
        }
        let scene = columns.scene(fields)?;
        Ok(Some(TrackRow { scene, frame, unit: time.unit, pedestrian, position, place: FilePlace::line(line) }))
    }

    /// What a stream has not told yet.
    pub(super) fn new_notes(&mut self) -> Vec<String> {
        let mut notes = if std::mem::replace(&mut self.is_told, true) { Vec::new() } else { self.notes() };
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

    fn notes(&self) -> Vec<String> {
        self.columns.notes(self.time.and_then(|time| time.assumed), self.unread(), self.is_stream)
    }

    fn unread(&self) -> &[usize] {
        self.unread.as_deref().unwrap_or(&self.columns.roles.unread)
    }

    /// What else may be done about two rows of a pedestrian in one frame: they may be of several recordings.
    pub(super) fn advice_on_same(&self, rows: [&str; 2]) -> String {
        self.columns.advice_on_same(self.unread(), rows)
    }
}
