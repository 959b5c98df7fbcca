//! How the format of a file is recognised.

use std::path::Path;

use crate::format::choice::ColumnChoice;
use crate::format::column_names::count_columns;
use crate::format::comments::{is_comment, names_in_comments};
use crate::format::edinburgh;
use crate::format::fault::{Fault, FormatError};
use crate::format::kind::Format;
use crate::format::order::{MOST_ROWS, Order, order};
use crate::format::separator::Separator;
use crate::format::text::end_of_lines;
use crate::format::vsp;

/// Least height in the fifth column of a file in centimetres: people in metres are lower.
const LEAST_CENTIMETRES: f64 = 20.0;
/// Seconds since 1970 that show that a column holds times.
const LEAST_TIME: f64 = 1e8;

impl Format {
    /// The format of a file, recognised by its extension and its content. Of text without a header, the number of its
    /// columns and their kind decide; of four columns, whether the first or the second counts the frames: along it,
    /// pedestrians move in small steps.
    ///
    /// Reading with a guessed format still checks everything. `choice`: the columns that the user names.
    ///
    /// # Errors
    /// Where both columns may count the frames; `path` names the file.
    pub fn guess(path: &Path, bytes: &[u8], choice: &ColumnChoice) -> Result<Self, FormatError> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        let named = |name: &str| extension.eq_ignore_ascii_case(name);
        let text = String::from_utf8_lossy(bytes);
        let lines = FilledLines::of(text.strip_prefix('\u{feff}').unwrap_or(&text));
        let Some(first) = lines.filled().next() else {
            return Ok(match () {
                () if named("ndjson") || named("jsonl") => Self::TrajNet,
                () if named("txt") => Self::SocialGan,
                () => Self::Table,
            });
        };
        if named("ndjson") || named("jsonl") || first.trim_start().starts_with('{') && first.trim() != "{" {
            return Ok(Self::TrajNet);
        }
        if vsp::is_first(first) {
            return Ok(Self::Vsp);
        }
        if edinburgh::is_first(first) {
            return Ok(Self::Edinburgh);
        }
        let has_header = !fields(Separator::of(first), first).iter().any(|field| is_number(field));
        let separator = Separator::of_numbers(first);
        let second = lines.filled().nth(1).unwrap_or_default();
        if count_columns(fields(separator, first).iter().map(String::as_str)) && second.contains('.') {
            return Ok(Self::Table);
        }
        let first = fields(separator, first);
        if has_header || lines.has_header_in_comment(first.len(), choice) {
            // A word of text that is no table, such as that of another file, is a row with too few fields.
            let is_json = first.first().is_some_and(|word| word.starts_with(['{', '[']));
            let is_row = separator == Separator::Blanks && first.len() < 3 && !named("csv") && !is_json;
            return Ok(if is_row { Self::SocialGan } else { Self::Table });
        }
        if let Some(format) = of_columns(&first, separator) {
            return Ok(format);
        }
        if separator == Separator::Comma && lines.are_star() {
            return Ok(Self::StarCsv);
        }
        let recognised = match (first.len(), separator) {
            (4, _) => lines.of_four(separator),
            (5, Separator::Blanks) => Ok(lines.of_five(separator)),
            (_, Separator::Blanks) if !named("csv") => Ok(Self::SocialGan),
            _ => Ok(Self::Table),
        };
        recognised.map_err(|fault| fault.in_line(&path.display().to_string(), 1))
    }
}

/// The format of rows of numbers whose first is this one, if their number and content show it.
fn of_columns(fields: &[String], separator: Separator) -> Option<Format> {
    let number = |index: usize| fields[index].parse::<f64>().ok();
    let numeric = fields.iter().all(|field| is_number(field));
    let is = |index: usize, holds: &dyn Fn(f64) -> bool| number(index).is_some_and(holds);
    let class = |index: usize| is(index, &|class| class.fract() == 0.0 && (1.0..=13.0).contains(&class));
    match fields.len() {
        10 if !is_number(&fields[9]) => Some(Format::Sdd),
        // Columns of the world are -1 where there is none.
        10 if numeric && (7..10).all(|index| is(index, &|world| (world + 1.0).abs() < 1e-9)) => Some(Format::Mot),
        10 if numeric && separator == Separator::Blanks && class(2) && is(6, &|length| length > 0.0) => {
            Some(Format::ApolloScape)
        }
        9 if numeric && separator == Separator::Comma && class(7) && is(8, &|seen| (0.0..=1.0).contains(&seen)) => {
            Some(Format::MotTruth)
        }
        8 if numeric && separator == Separator::Comma && is(0, &|time| time > LEAST_TIME) => Some(Format::Atc),
        // Nobody moves up or down.
        8 if separator == Separator::Blanks && is(6, &|v_z| v_z.is_nan() || v_z.abs() < 1e-6) => Some(Format::Obsmat),
        17.. if separator == Separator::Blanks && !is_number(&fields[2]) => Some(Format::Kitti),
        _ => None,
    }
}

#[derive(Debug, Clone, Copy)]
struct FilledLines<'a> {
    text: &'a str,
    end: char,
}

impl<'a> FilledLines<'a> {
    fn of(text: &'a str) -> Self {
        let end = end_of_lines(text);
        Self { text, end }
    }

    fn filled(self) -> impl Iterator<Item = &'a str> {
        self.text.split(self.end).filter(|line| !line.trim().is_empty() && !is_comment(line))
    }

    fn has_header_in_comment(self, count: usize, choice: &ColumnChoice) -> bool {
        let comments = self.text.split(self.end).take_while(|line| line.trim().is_empty() || is_comment(line));
        names_in_comments(comments, count, choice).is_some()
    }

    /// Whether the lines are four of numbers. Four lines of four numbers may also be a table whose header was
    /// forgotten.
    fn are_star(self) -> bool {
        let counts = self.filled().take(5).map(|line| {
            let fields = fields(Separator::Comma, line);
            if fields.first().is_some_and(|field| is_number(field)) { fields.len() } else { 0 }
        });
        let counts: Vec<usize> = counts.collect();
        counts.len() == 4 && counts.iter().all(|count| ![0, 4].contains(count))
    }

    /// The first N columns of the rows in which these are numbers.
    fn numbers<const N: usize>(self, separator: Separator) -> impl Iterator<Item = [f64; N]> {
        self.filled().filter_map(move |line| {
            let fields = separator.fields(line).ok()?;
            let numbers = fields.iter().take(N).map(|field| separator.with_point(field).parse().ok());
            numbers.collect::<Option<Vec<f64>>>()?.try_into().ok()
        })
    }

    fn order(self, separator: Separator) -> Order {
        let rows = self.numbers(separator).take(MOST_ROWS);
        order(&rows.map(|[a, b, x, y]| ([a, b], [x, y])).collect::<Vec<_>>())
    }

    fn of_four(self, separator: Separator) -> Result<Format, Fault> {
        match self.order(separator) {
            Order::FrameFirst => Ok(Format::SocialGan),
            Order::PedestrianFirst => Ok(Format::IdFirst),
            Order::Unclear => Err("the first two columns may be frame and pedestrian, or pedestrian and frame: both \
                                   give tracks; write the line frame,pedestrian,x,y above them, or \
                                   pedestrian,frame,x,y (with the separators of the rows)"
                .into()),
            Order::Neither => Err("the first two columns are not frame and pedestrian: hardly any pedestrian would \
                                   have two rows; write the names of the columns above the rows, such as \
                                   x,y,frame,pedestrian (with their separators)"
                .into()),
        }
    }

    /// `PeTrack` writes the pedestrian first; rows in which the frame is first are refused for their fifth column. A
    /// single row shows no order.
    fn of_five(self, separator: Separator) -> Format {
        let rows = || self.numbers::<5>(separator);
        if rows().nth(1).is_some() && self.order(separator) == Order::FrameFirst {
            Format::SocialGan
        } else if rows().all(|[.., height]| height >= LEAST_CENTIMETRES) {
            Format::PeTrackCm
        } else {
            Format::PeTrack
        }
    }
}

/// The fields of a line, without empty ones at its end; numbers have a decimal point.
fn fields(separator: Separator, line: &str) -> Vec<String> {
    let fields = separator.fields(line).unwrap_or_default();
    let mut fields: Vec<String> = fields.iter().map(|field| separator.with_point(field).into_owned()).collect();
    while fields.last().is_some_and(String::is_empty) {
        fields.pop();
    }
    fields
}

fn is_number(field: &str) -> bool {
    field.parse::<f64>().is_ok()
}
