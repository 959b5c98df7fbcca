//! The supported formats, and how the format of a file is recognised.

use std::fmt;
use std::path::Path;

/// Format of a file of tracks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Four lines of comma-separated numbers, one field per observation: frame, pedestrian, **y**, **x** (m). The files
    /// of the `star` convention.
    StarCsv,
    /// One observation per line, four fields separated by tabs or blanks: frame, pedestrian, x, y (m).
    /// The files of the `social-gan` convention.
    SocialGan,
    /// A comma-separated table whose header names `frame`, `pedestrian`, `x` and `y` (m) in any order: meant for the
    /// user's own tracks.
    Table,
    /// The newline-delimited JSON of TrajNet++, with one `{"track": {"f", "p", "x", "y"}}` per line (frame, pedestrian,
    /// metres). Lines of forecasts (with `prediction_number`), of scenes and of other kinds are skipped.
    TrajNet,
    /// The `obsmat.txt` of the ETH recordings: frame, pedestrian, x, z, **y** (m) and three velocities, separated by
    /// blanks.
    Obsmat,
}

impl Format {
    /// Every format.
    pub const ALL: [Self; 5] = [Self::StarCsv, Self::SocialGan, Self::Table, Self::TrajNet, Self::Obsmat];

    /// The format's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::StarCsv => "star-csv",
            Self::SocialGan => "social-gan",
            Self::Table => "table",
            Self::TrajNet => "trajnet",
            Self::Obsmat => "obsmat",
        }
    }

    /// The format of a file, recognised by its extension and its first lines.
    ///
    /// - `.ndjson` and `.jsonl`, or a first line that begins with `{`: [`TrajNet`](Self::TrajNet);
    /// - a first line without a comma, unless the file is called `.csv`: [`Obsmat`](Self::Obsmat) where it has 8
    ///   fields, else [`SocialGan`](Self::SocialGan);
    /// - anything else: [`StarCsv`](Self::StarCsv) where the file is four lines of more than four numbers each, else
    ///   [`Table`](Self::Table).
    ///
    /// Extensions may be in capital letters. Reading with a guessed format still checks everything.
    #[must_use]
    pub fn guess(path: &Path, bytes: &[u8]) -> Self {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        let named = |name: &str| extension.eq_ignore_ascii_case(name);
        let lines: Vec<&[u8]> = bytes.split(|&byte| byte == b'\n').take(6).collect();
        let first = lines
            .iter()
            .find(|line| !line.trim_ascii().is_empty())
            .map_or(&b""[..], |line| line.trim_ascii());
        if named("ndjson") || named("jsonl") || first.starts_with(b"{") {
            Self::TrajNet
        } else if !first.contains(&b',') && (named("txt") || !(named("csv") || first.is_empty())) {
            let fields = first.split(u8::is_ascii_whitespace).filter(|field| !field.is_empty());
            if fields.count() == 8 {
                Self::Obsmat
            } else {
                Self::SocialGan
            }
        } else if is_star(&lines) {
            Self::StarCsv
        } else {
            Self::Table
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Whether the file is four lines of numbers. Four lines of four numbers may also be a table whose header was
/// forgotten.
fn is_star(lines: &[&[u8]]) -> bool {
    let filled = lines.iter().filter(|line| !line.trim_ascii().is_empty());
    let number = |field: &[u8]| {
        let text = std::str::from_utf8(field).unwrap_or("");
        text.trim().parse::<f64>().is_ok()
    };
    filled.clone().count() == 4
        && filled.into_iter().all(|line| {
            line.split(|&byte| byte == b',').count() != 4 && line.split(|&byte| byte == b',').next().is_some_and(number)
        })
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
"#;
        for case in cases.trim().lines() {
            let (file, format) = case.split_once(" => ").unwrap();
            let (name, text) = file.split_once("::").unwrap();
            let text = text.replace("\\n", "\n").replace("\\t", "\t");
            let guessed = Format::guess(name.as_ref(), text.as_bytes());
            assert_eq!(guessed.name(), format, "{case}");
        }
    }
}
