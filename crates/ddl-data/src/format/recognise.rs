//! How the format of a file is recognised.

use std::path::Path;

use crate::error::FormatError;
use crate::format::choice::ColumnChoice;
use crate::format::kind::Format;
use crate::format::order::{MOST_ROWS, Order, order};
use crate::format::place::FilePlace;
use crate::format::separator::Separator;
use crate::format::text::{in_comment, is_comment};

/// Least height in the fifth column of a file in centimetres: people in metres are lower.
const LEAST_CENTIMETRES: f64 = 20.0;
/// Seconds since 1970 that show that a column holds times.
const LEAST_TIME: f64 = 1e8;

impl Format {
    /// The format of a file, recognised by its extension and its content. Of text without a header, the number of its
    /// columns and their kind decide; of four columns, whether the first or the second counts the frames: along it,
    /// pedestrians move in small steps.
    ///
    /// Reading with a guessed format still checks everything.
    ///
    /// # Errors
    /// Where both columns may count the frames; `path` names the file.
    pub fn guess(path: &Path, bytes: &[u8]) -> Result<Self, FormatError> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        let named = |name: &str| extension.eq_ignore_ascii_case(name);
        let text = String::from_utf8_lossy(bytes);
        let lines = Lines::of(text.strip_prefix('\u{feff}').unwrap_or(&text));
        let Some(first) = lines.filled().next() else {
            return Ok(match () {
                () if named("ndjson") || named("jsonl") => Self::TrajNet,
                () if named("txt") => Self::SocialGan,
                () => Self::Table,
            });
        };
        if named("ndjson") || named("jsonl") || first.trim_start().starts_with('{') {
            return Ok(Self::TrajNet);
        }
        let separator = Separator::of_numbers(first);
        let has_header = !fields(Separator::of(first), first).iter().any(|field| is_number(field));
        if has_header || lines.has_header_in_comment() {
            // A word of text that is no table, such as that of another file, is a row with too few fields.
            let is_row = separator == Separator::Blanks && fields(separator, first).len() < 3 && !named("csv");
            return Ok(if is_row { Self::SocialGan } else { Self::Table });
        }
        if separator == Separator::Comma && lines.are_star() {
            return Ok(Self::StarCsv);
        }
        if let Some(format) = of_columns(&fields(separator, first), separator) {
            return Ok(format);
        }
        match (separator, fields(separator, first).len()) {
            (Separator::Blanks, 4) => lines
                .of_four(separator)
                .map_err(|problem| FilePlace::line(1).wrong(&path.display().to_string(), problem)),
            (Separator::Blanks, 5) => Ok(lines.of_five(separator)),
            (Separator::Blanks, _) if !named("csv") => Ok(Self::SocialGan),
            _ => Ok(Self::Table),
        }
    }
}

/// The format of rows of numbers whose first is this one, if their number and kind show it.
fn of_columns(fields: &[String], separator: Separator) -> Option<Format> {
    let by_commas = separator == Separator::Comma;
    let numeric = fields.iter().all(|field| is_number(field));
    let is_time = || fields[0].parse::<f64>().is_ok_and(|time| time > LEAST_TIME);
    match fields.len() {
        10 if !is_number(&fields[9]) => Some(Format::Sdd),
        10 if numeric && by_commas => Some(Format::Mot),
        10 if numeric => Some(Format::ApolloScape),
        9 if numeric => Some(Format::MotTruth),
        8 if numeric && by_commas && is_time() => Some(Format::Atc),
        8 if separator == Separator::Blanks => Some(Format::Obsmat),
        17.. if !by_commas && !is_number(&fields[2]) => Some(Format::Kitti),
        _ => None,
    }
}

/// The lines of a file.
#[derive(Debug, Clone, Copy)]
struct Lines<'a> {
    text: &'a str,
    end: char,
}

impl<'a> Lines<'a> {
    fn of(text: &'a str) -> Self {
        let end = if text.contains('\n') { '\n' } else { '\r' };
        Self { text, end }
    }

    fn filled(self) -> impl Iterator<Item = &'a str> {
        let lines = self.text.split(self.end);
        lines.filter(|line| !line.trim().is_empty() && !is_comment(line))
    }

    fn has_header_in_comment(self) -> bool {
        let lines = self.text.split(self.end);
        let mut comments = lines.take_while(|line| line.trim().is_empty() || is_comment(line));
        comments.any(|comment| in_comment(comment, &ColumnChoice::default()).is_some())
    }

    /// Whether the lines are four of numbers. Four lines of four numbers may also be a table whose header was
    /// forgotten.
    fn are_star(self) -> bool {
        let counts = self.filled().take(5).map(|line| {
            let fields = fields(Separator::Comma, line);
            if fields.first().is_some_and(|field| is_number(field)) {
                fields.len()
            } else {
                0
            }
        });
        let counts: Vec<usize> = counts.collect();
        counts.len() == 4 && counts.iter().all(|count| ![0, 4].contains(count))
    }

    fn of_four(self, separator: Separator) -> Result<Format, String> {
        let rows = self.filled().filter_map(|line| {
            let fields = fields(separator, line);
            let number = |index: usize| fields.get(index)?.parse::<f64>().ok();
            Some(([number(0)?, number(1)?], [number(2)?, number(3)?]))
        });
        match order(&rows.take(MOST_ROWS).collect::<Vec<_>>()) {
            Order::FrameFirst => Ok(Format::SocialGan),
            Order::PedestrianFirst => Ok(Format::IdFirst),
            Order::Unclear([first, second]) => Err(format!(
                "the first two columns may be frame and pedestrian, or pedestrian and frame: both give tracks alike \
                 ({first:.2} and {second:.2} m from row to row); write the line frame pedestrian x y, or pedestrian \
                 frame x y, above them"
            )),
        }
    }

    fn of_five(self, separator: Separator) -> Format {
        let is_high = |line: &str| {
            let height = fields(separator, line)
                .get(4)
                .and_then(|height| height.parse::<f64>().ok());
            height.is_some_and(|height| height >= LEAST_CENTIMETRES)
        };
        if self.filled().all(is_high) {
            Format::PeTrackCm
        } else {
            Format::PeTrack
        }
    }
}

/// The fields of a line, without empty ones at its end.
fn fields(separator: Separator, line: &str) -> Vec<String> {
    let fields = separator.fields(line, 1, "").unwrap_or_default();
    let mut fields: Vec<String> = fields.into_iter().map(std::borrow::Cow::into_owned).collect();
    while fields.last().is_some_and(String::is_empty) {
        fields.pop();
    }
    fields
}

fn is_number(field: &str) -> bool {
    field.parse::<f64>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_is_recognised() {
        let cases = r#"
a.ndjson:: => trajnet
a::\n {"scene": {}} => trajnet
a.txt::0 1 2 3 4 5 6 7\n => obsmat
a.txt::0\t1\t2\t3\n => social-gan
a::0 1 2 3\n => social-gan
a.csv::0,1,2,3,4\n1,1,1,1,1\n0,0,0,0,0\n1,1,1,1,1\n => star-csv
a.csv::frame,pedestrian,x,y\n0,1,2,3\n => table
a.csv::0,1,2,3\n0,1,2,3\n0,1,2,3\n0,1,2,3\n => table
a.csv:: => table
a.txt:: => social-gan
a.txt::frame,pedestrian,x,y\n0,1,2,3\n => table
a.NDJSON:: => trajnet
a.Jsonl:: => trajnet
a.TXT::0\t1\t2\t3\n => social-gan
a.CSV::frame pedestrian x y\n => table
a.txt::frame pedestrian x y\n0 1 2 3\n => table
"#;
        for case in cases.trim().lines() {
            let (file, format) = case.split_once(" => ").unwrap();
            let (name, text) = file.split_once("::").unwrap();
            let text = text.replace("\\n", "\n").replace("\\t", "\t");
            let guessed = Format::guess(name.as_ref(), text.as_bytes()).unwrap();
            assert_eq!(guessed.name(), format, "{case}");
        }
    }
}
