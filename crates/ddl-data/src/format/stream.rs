//! Reading of tracks frame by frame, while they arrive.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufRead, Read as _};
use std::sync::Arc;

use super::field::PedestrianField;
use super::kind::Format;
use super::place::FilePlace;
use super::rows::TrackRow;
use super::table::TrackColumns;
use super::{blanks, trajnet};
use crate::error::{DataError, FormatError, FormatProblem};
use crate::names::Numbering;
use crate::{PedestrianId, PedestrianNames, Position};

const LONGEST_LINE: usize = 1 << 16;
/// Most pedestrians of one frame, beyond any crowd a tracker sees. It bounds the memory if the frame number never
/// changes.
const LARGEST_CROWD: usize = 100_000;
/// Words that are remembered: more than any frame has.
const MOST_WORDS: usize = 2 * LARGEST_CROWD;

/// The positions of all pedestrians at one frame.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Frame {
    /// The raw frame number.
    pub number: i64,
    /// Pedestrians and their positions (m), in the order of the lines.
    pub people: Vec<(PedestrianId, Position)>,
    /// The words that stand for pedestrians which the lines name by words.
    pub names: PedestrianNames,
}

/// Reads tracks frame by frame, as a tracker writes them: in order of time, one observation per line.
///
/// A frame is complete when a line of a later frame arrives, at an empty line, or at the end. The first line determines
/// the format: a header (`table`), a JSON object (`trajnet`), or four or eight columns (`social-gan`, `obsmat`). Files
/// of the `star` convention are not in order of time and cannot be streamed.
///
/// Pedestrians may be words; a number stays a number, also beside words. Memory is bounded: it holds the pedestrians of
/// one frame, at most 100,000, and the last 200,000 words. A pedestrian whose word was forgotten gets a new id.
#[derive(Debug)]
pub struct FrameReader<R> {
    reader: R,
    origin: String,
    lines: usize,
    kind: Option<Kind>,
    /// The frame rate that scenes state.
    rate: trajnet::Rate,
    words: Numbering,
    /// Pedestrian numbers not written as plain digits, such as `17.0`: the first 200,000 of them.
    numbers: BTreeSet<Box<str>>,
    current: Option<Growing>,
    /// The last frame that was returned.
    last: Option<i64>,
    ended: bool,
}

#[derive(Debug)]
struct Growing {
    frame: Frame,
    lines: BTreeMap<PedestrianId, usize>,
    words: BTreeMap<PedestrianId, Arc<str>>,
}

#[derive(Debug)]
enum Kind {
    Table(TrackColumns),
    TrajNet,
    SocialGan,
    Obsmat,
}

impl<R: BufRead> FrameReader<R> {
    /// A reader that has read nothing yet; `origin` is the name in messages.
    pub fn new(reader: R, origin: impl Into<String>) -> Self {
        Self {
            reader,
            origin: origin.into(),
            lines: 0,
            kind: None,
            rate: trajnet::Rate::default(),
            words: Numbering::remembering(MOST_WORDS),
            numbers: BTreeSet::new(),
            current: None,
            last: None,
            ended: false,
        }
    }

    /// The next complete frame; blocks until it has arrived. `None` at the end.
    ///
    /// # Errors
    /// If the input cannot be read, or a line is wrong: see [`FormatError`]. After an error the reader continues with
    /// the next line.
    pub fn next_frame(&mut self) -> Result<Option<Frame>, DataError> {
        while !self.ended {
            let Some(text) = self.line()? else {
                self.ended = true;
                break;
            };
            if text.trim().is_empty() {
                if let Some(frame) = self.whole() {
                    return Ok(Some(frame));
                }
                continue;
            }
            let Some(row) = self.row(&text)? else {
                continue;
            };
            if let Some(frame) = self.add(row)? {
                return Ok(Some(frame));
            }
        }
        Ok(self.whole())
    }

    /// The part of the current frame that has been read, for callers that stop after an error.
    pub fn unfinished(&mut self) -> Option<Frame> {
        self.whole()
    }

    /// Frames per second, where a line so far has stated it: the `fps` of TrajNet++ scenes.
    pub fn rate(&self) -> Option<f64> {
        self.rate.frames_a_second
    }

    /// The next line without its line ending; `None` at the end of the file.
    fn line(&mut self) -> Result<Option<String>, DataError> {
        let mut bytes = Vec::new();
        let mut limited = self.reader.by_ref().take(LONGEST_LINE as u64 + 1);
        let read = limited.read_until(b'\n', &mut bytes);
        read.map_err(|source| self.unreadable(source))?;
        if bytes.is_empty() {
            return Ok(None);
        }
        self.lines += 1;
        if bytes.len() > LONGEST_LINE {
            if bytes.last() != Some(&b'\n') {
                self.skip_line()?;
            }
            let limit = LONGEST_LINE;
            return Err(self.wrong(FormatProblem::LongLine { limit }).into());
        }
        match String::from_utf8(bytes) {
            Err(_) => Err(self.wrong(FormatProblem::NotUtf8).into()),
            Ok(text) if self.lines == 1 => Ok(Some(text.trim_start_matches('\u{feff}').to_owned())),
            Ok(text) => Ok(Some(text)),
        }
    }

    fn skip_line(&mut self) -> Result<(), DataError> {
        loop {
            let (skipped, ended) = match self.reader.fill_buf() {
                Err(source) => return Err(self.unreadable(source)),
                Ok([]) => return Ok(()),
                Ok(bytes) => match bytes.iter().position(|&byte| byte == b'\n') {
                    Some(end) => (end + 1, true),
                    None => (bytes.len(), false),
                },
            };
            self.reader.consume(skipped);
            if ended {
                return Ok(());
            }
        }
    }

    fn unreadable(&self, source: std::io::Error) -> DataError {
        let path = self.origin.clone().into();
        DataError::Read { path, source }
    }

    fn row(&mut self, text: &str) -> Result<Option<TrackRow>, FormatError> {
        let (line, origin) = (self.lines, self.origin.as_str());
        let Some(kind) = &self.kind else {
            let kind = match Format::guess("".as_ref(), text.as_bytes()) {
                Format::TrajNet => Kind::TrajNet,
                Format::SocialGan => Kind::SocialGan,
                Format::Obsmat => Kind::Obsmat,
                Format::Table | Format::StarCsv => {
                    self.kind = Some(Kind::Table(TrackColumns::of_line(text, line, origin)?));
                    return Ok(None);
                }
            };
            self.kind = Some(kind);
            return self.row(text);
        };
        match kind {
            Kind::Table(columns) => columns.row_of_line(text, line, origin).map(Some),
            Kind::SocialGan => blanks::social_gan(text, line, origin).map(Some),
            Kind::Obsmat => blanks::obsmat(text, line, origin).map(Some),
            Kind::TrajNet => trajnet::observation(text, line, origin, &mut self.rate),
        }
    }

    /// Adds an observation. Returns the previous frame if this observation starts a new one.
    fn add(&mut self, seen: TrackRow) -> Result<Option<Frame>, FormatError> {
        let reached = self.current.as_ref().map(|growing| growing.frame.number);
        if let Some(last) = reached.or(self.last)
            && (seen.frame < last || (reached.is_none() && seen.frame == last))
        {
            let frame = seen.frame;
            return Err(self.wrong(FormatProblem::OutOfOrder { frame, last }));
        }
        let before = if reached == Some(seen.frame) {
            None
        } else {
            self.whole()
        };
        let line = self.lines;
        let growing = self.current.get_or_insert_with(|| Growing {
            frame: Frame {
                number: seen.frame,
                people: Vec::new(),
                names: PedestrianNames::default(),
            },
            lines: BTreeMap::new(),
            words: BTreeMap::new(),
        });
        let pedestrian = match seen.pedestrian {
            PedestrianField::Number(number, None) => PedestrianId(number),
            // After a word, `1e3` is a word as well, unless it was a number before.
            PedestrianField::Number(number, Some(text))
                if self.words.is_empty() || self.numbers.contains(&text) =>
            {
                if self.numbers.len() < MOST_WORDS {
                    self.numbers.insert(text);
                }
                PedestrianId(number)
            }
            field => {
                let (id, word) = self.words.number(&field.written());
                growing.words.insert(id, word);
                id
            }
        };
        if let Some(&first_line) = growing.lines.get(&pedestrian) {
            let names = PedestrianNames::new(std::mem::take(&mut growing.words));
            let problem = FormatProblem::Duplicate {
                pedestrian: Box::new(names.of(pedestrian)),
                frame: seen.frame,
                first_line,
            };
            return Err(self.wrong(problem));
        }
        if growing.lines.len() == LARGEST_CROWD {
            let (frame, limit) = (seen.frame, LARGEST_CROWD);
            return Err(self.wrong(FormatProblem::Crowd { frame, limit }));
        }
        growing.lines.insert(pedestrian, line);
        growing.frame.people.push((pedestrian, seen.position));
        Ok(before)
    }

    fn whole(&mut self) -> Option<Frame> {
        let growing = self.current.take()?;
        self.last = Some(growing.frame.number);
        Some(Frame {
            names: PedestrianNames::new(growing.words),
            ..growing.frame
        })
    }

    fn wrong(&self, problem: FormatProblem) -> FormatError {
        FilePlace::line(self.lines).wrong(&self.origin, problem)
    }
}
