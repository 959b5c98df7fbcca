//! Tracks as they arrive: a frame as soon as it is whole.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufRead, Read as _};
use std::sync::Arc;

use super::field::Who;
use super::kind::Format;
use super::place::FilePlace;
use super::rows::TrackRow;
use super::table::TrackColumns;
use super::{blanks, trajnet};
use crate::error::{DataError, FormatError, FormatProblem};
use crate::names::Numbering;
use crate::{PedestrianId, PedestrianNames, Position};

const LONGEST_LINE: usize = 1 << 16;
/// People of the fullest frame: beyond any crowd a tracker sees. A frame number that stands still must not fill the memory.
const LARGEST_CROWD: usize = 100_000;
/// Words that are remembered: more than there are in any frame.
const MOST_WORDS: usize = 2 * LARGEST_CROWD;

/// Everybody at one moment.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Frame {
    /// The raw frame number.
    pub number: i64,
    /// Who is where (m), in the order of the lines.
    pub people: Vec<(PedestrianId, Position)>,
    /// The words of those whom the lines know by words.
    pub names: PedestrianNames,
}

/// Reads tracks frame by frame, as a tracker writes them: in order of time, one observation a line.
///
/// A frame is whole when a line of a later one comes, when an empty line comes, or at the end. What the lines are is
/// told from the first: a header (`table`), a JSON object (`trajnet`), or four or eight columns (`social-gan`,
/// `obsmat`). Files of the `star` convention do not arrive in order of time.
///
/// Pedestrians may be words; a number stays one, also beside words. Memory is bounded by the people of a frame, 100,000
/// at most, and the last 200,000 words: whose word was forgotten is somebody new.
#[derive(Debug)]
pub struct FrameReader<R> {
    reader: R,
    origin: String,
    lines: usize,
    kind: Option<Kind>,
    /// What scenes say of it.
    rate: trajnet::Rate,
    words: Numbering,
    /// Pedestrians' numbers that are not written as plain digits, such as `17.0`: the first 200,000 of them.
    numbers: BTreeSet<Box<str>>,
    current: Option<Growing>,
    /// The last frame that was given out.
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
    /// Nothing read yet; `origin` is the name in messages.
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

    /// The next whole frame; waits for it. `None` at the end.
    ///
    /// # Errors
    /// If nothing can be read any more, or a line is wrong: see [`FormatError`]. After an error the reader is at the
    /// next line.
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

    /// The frame that is being read, as far as it has been: for who gives up after an error.
    pub fn unfinished(&mut self) -> Option<Frame> {
        self.whole()
    }

    /// How many frames follow each other in a second, where a line so far has said so: the `fps` of TrajNet++ scenes.
    pub fn rate(&self) -> Option<f64> {
        self.rate.frames_a_second
    }

    /// The next line without its end; `None` at the end of the file.
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

    /// Adds an observation; the frame before, if this is the first of a new one.
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
        let pedestrian = match seen.who {
            Who::Number(number, None) => PedestrianId(number),
            // after a word, `1e3` is one as well, unless it was a number before
            Who::Number(number, Some(text))
                if self.words.is_empty() || self.numbers.contains(&text) =>
            {
                if self.numbers.len() < MOST_WORDS {
                    self.numbers.insert(text);
                }
                PedestrianId(number)
            }
            who => {
                let (id, word) = self.words.number(&who.written());
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
