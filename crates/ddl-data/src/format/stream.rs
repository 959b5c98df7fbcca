//! Reading of tracks frame by frame, while they arrive.

#![expect(clippy::ref_option, reason = "the keys of the map of scenes")]

use std::collections::{BTreeMap, VecDeque};
use std::io::BufRead;
use std::sync::Arc;
use std::time::{Duration, Instant};

use ddl_core::{Numbering, PedestrianId, PedestrianName, PedestrianNames, Position};

use crate::clock::TimeUnit;
use crate::file_error::DataError;
use crate::format::choice::ColumnChoice;
use crate::format::comments::{is_comment, rate_of};
use crate::format::fault::{Fault, FormatError};
use crate::format::kind::Format;
use crate::format::lines::TextLines;
use crate::format::problem::{MIXED_TIMES, duplicate, when};
use crate::format::row_reader::RowReader;
use crate::format::rows::TrackRow;
use crate::format::track_columns::TrackColumns;
use crate::format::trajnet;
use crate::scene_name::SceneName;

const LONGEST_LINE: usize = 1 << 16;
/// Largest number of pedestrians in a frame, above that of any tracked crowd. It bounds the memory if the frame number
/// never changes.
const LARGEST_CROWD: usize = 100_000;
/// Largest number of names that are kept: more than any frame has.
const MOST_WORDS: usize = 2 * LARGEST_CROWD;
/// Largest number of scenes at a time, above what one machine can forecast.
const MOST_SCENES: usize = 1_000;
/// Time without a line after which a scene is forgotten.
const IDLE_TIMEOUT: Duration = Duration::from_mins(10);

/// The pedestrians of one scene at one frame.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Frame {
    /// The name of the scene; `None` if the lines name no scene and all belong to one.
    pub scene: Option<SceneName>,
    /// Whether this is the first frame of the scene, or the first since the scene was forgotten.
    pub is_first: bool,
    /// The raw frame number, or the time stamp in microseconds.
    pub number: i64,
    /// Pedestrians and their positions (m), in the order of the lines.
    pub pedestrians: Vec<(PedestrianId, Position)>,
    /// The names of pedestrians that are not named by numbers.
    pub names: PedestrianNames,
}

/// Reads tracks frame by frame, as a tracker writes them: in order of time, one observation per line.
///
/// A frame is complete when a line of a later frame arrives, at an empty line, or at the end. The first line determines
/// the format, by its header, as a JSON object (`trajnet`), or by its columns: four are frame, pedestrian, x and y,
/// which is told once. Files of the `star` convention are not in order of time and cannot be streamed.
///
/// Pedestrians may be named by words, by numbers or by both. Memory is bounded by the pedestrians of incomplete frames,
/// 100,000 at most, and the 200,000 words used last. A word that has been forgotten gets a new pedestrian number.
///
/// # Scenes
/// A table with a column `scene`, or lines of JSON with a field `track.scene`, may hold several scenes. Their lines may
/// alternate in any order; only the frames of each scene must be in order of time. A frame is complete when a later
/// frame of the *same* scene arrives, at an empty line right after a line of the scene, or at the end. There are at
/// most 1,000 scenes at a time. A scene without a line for 10 minutes is forgotten, after its last frame has been
/// returned.
#[derive(Debug)]
pub struct FrameReader<R> {
    lines: TextLines<R>,
    kind: Option<Kind>,
    choice: ColumnChoice,
    /// The comments before the first observation.
    comments: String,
    /// Frame numbers per second, if a comment states it.
    frame_rate: Option<f64>,
    /// What lines of TrajNet++ without an observation say.
    others: trajnet::OtherLines,
    words: Numbering,
    scenes: BTreeMap<Option<SceneName>, SceneProgress>,
    /// The last frames of scenes that were forgotten.
    left: VecDeque<Frame>,
    /// The scene of the last line.
    last_scene: Option<SceneName>,
    first: Option<FirstRow>,
    /// Number of pedestrians in incomplete frames.
    unfinished: usize,
    idle_timeout: Duration,
    ended: bool,
}

/// What the first observation shows of all.
#[derive(Debug, Clone, Copy)]
struct FirstRow {
    is_named: bool,
    unit: Option<TimeUnit>,
    line: usize,
}

#[derive(Debug)]
struct SceneProgress {
    current: Option<Growing>,
    /// The last frame that was returned.
    last: Option<i64>,
    heard: Instant,
}

impl SceneProgress {
    fn unseen() -> Self {
        Self { current: None, last: None, heard: Instant::now() }
    }
}

#[derive(Debug)]
struct Growing {
    frame: Frame,
    lines: BTreeMap<PedestrianId, usize>,
    words: BTreeMap<PedestrianId, Arc<str>>,
}

#[derive(Debug)]
enum Kind {
    Text(Box<RowReader>),
    TrajNet,
}

impl<R: BufRead> FrameReader<R> {
    /// Creates a reader; `origin` names the input in messages.
    pub fn new(reader: R, origin: impl Into<String>) -> Self {
        Self {
            lines: TextLines::new(reader, origin, LONGEST_LINE, "is it a file of tracks?"),
            kind: None,
            choice: ColumnChoice::default(),
            comments: String::new(),
            frame_rate: None,
            others: trajnet::OtherLines::default(),
            words: Numbering::remembering(MOST_WORDS),
            scenes: BTreeMap::new(),
            left: VecDeque::new(),
            last_scene: None,
            first: None,
            unfinished: 0,
            idle_timeout: IDLE_TIMEOUT,
            ended: false,
        }
    }

    /// Sets another time without a line after which a scene is forgotten.
    #[must_use]
    pub fn forgetting_after(self, idle_timeout: Duration) -> Self {
        Self { idle_timeout, ..self }
    }

    /// Takes the columns of text as the user says.
    #[must_use]
    pub fn with_columns(self, choice: ColumnChoice) -> Self {
        Self { choice, ..self }
    }

    /// Waits for the next complete frame; `None` at the end.
    ///
    /// # Errors
    /// If the input cannot be read, or a line is invalid: see [`FormatError`]. After an error the reader continues with
    /// the next line.
    pub fn next_frame(&mut self) -> Result<Option<Frame>, DataError> {
        while !self.ended {
            if let Some(frame) = self.left.pop_front() {
                return Ok(Some(frame));
            }
            let Some(text) = self.lines.next_line()? else {
                self.ended = true;
                break;
            };
            let text = text.to_owned();
            let frame = if text.trim().is_empty() {
                self.take_frame(&self.last_scene.clone())
            } else {
                let added = self.row(&text)?.map(|row| self.add(row)).transpose();
                added.map_err(|fault| self.lines.wrong(fault))?.flatten()
            };
            if frame.is_some() {
                return Ok(frame);
            }
        }
        Ok(self.unfinished())
    }

    /// Takes the next incomplete frame; `None` if there is none. For callers that stop after an error.
    pub fn unfinished(&mut self) -> Option<Frame> {
        if let Some(frame) = self.left.pop_front() {
            return Some(frame);
        }
        let mut scenes = self.scenes.iter();
        let (name, _) = scenes.find(|(_, scene)| scene.current.is_some())?;
        self.take_frame(&name.clone())
    }

    /// Whether the observations so far name scenes.
    pub fn names_scenes(&self) -> bool {
        self.first.is_some_and(|first| first.is_named)
    }

    /// What the time stamps of the lines count; `None` for frame numbers. Time stamps are given in microseconds.
    pub fn time_unit(&self) -> Option<TimeUnit> {
        self.first?.unit
    }

    /// Takes the notes on what was assumed and left out since the last call, a sentence each.
    pub fn take_notes(&mut self) -> Vec<String> {
        match &mut self.kind {
            Some(Kind::Text(columns)) => columns.new_notes(),
            Some(Kind::TrajNet) => self.others.filter.news(),
            None => Vec::new(),
        }
    }

    /// Frame numbers per second, if a comment before the first line states it.
    pub fn frame_rate(&self) -> Option<f64> {
        self.frame_rate
    }

    /// Rows of a pedestrian per second, if a line so far states it: the `fps` of TrajNet++ scenes.
    pub fn rate(&self) -> Option<f64> {
        self.others.frames_a_second
    }

    /// The observation of a line, if it holds one. The first line but comments shows of which kind all are.
    fn row(&mut self, text: &str) -> Result<Option<TrackRow>, FormatError> {
        let line = self.lines.number();
        let row = match &mut self.kind {
            Some(Kind::Text(reader)) => reader.row_of_line(text, line),
            Some(Kind::TrajNet) => trajnet::observation(text, line, &mut self.others).map_err(Fault::from),
            None if is_comment(text) => {
                self.frame_rate = self.frame_rate.or(rate_of(text));
                if self.comments.len() + text.len() <= LONGEST_LINE {
                    self.comments += text;
                }
                Ok(None)
            }
            None => {
                let comments = std::mem::take(&mut self.comments);
                let (kind, is_header) =
                    self.kind_of(&comments, text).map_err(|error| error.in_text(self.lines.origin()))?;
                self.kind = Some(kind);
                return if is_header { Ok(None) } else { self.row(text) };
            }
        };
        row.map_err(|fault| self.lines.wrong(fault))
    }

    /// The kind of a stream that begins with these comments and this line, and whether the line is a header.
    fn kind_of(&mut self, comments: &str, text: &str) -> Result<(Kind, bool), FormatError> {
        let begin = comments.to_owned() + text;
        let format = Format::guess("".as_ref(), begin.as_bytes(), &self.choice)?;
        if matches!(format, Format::Vsp | Format::Edinburgh) {
            let problem = format!("lines of the format {format} are not in order of time; give the file");
            return Err(self.lines.wrong(problem));
        }
        if format == Format::TrajNet {
            self.choice.refuse_for(format).map_err(|problem| self.lines.wrong(problem))?;
            return Ok((Kind::TrajNet, false));
        }
        let comments: Vec<&str> = comments.lines().collect();
        let (columns, is_header) = TrackColumns::of((format, &self.choice), &comments, text, self.lines.number())?;
        self.frame_rate = self.frame_rate.or(columns.rate());
        Ok((Kind::Text(Box::new(RowReader::of_stream(columns).map_err(|fault| self.lines.wrong(fault))?)), is_header))
    }

    /// Adds an observation. If it begins a new frame of its scene, returns the previous frame of the scene.
    fn add(&mut self, seen: TrackRow) -> Result<Option<Frame>, Fault> {
        self.refuse_mixed(&seen)?;
        self.note_activity(&seen.scene)?;
        self.last_scene.clone_from(&seen.scene);
        let name = seen.scene.clone();
        let before = self.begin_frame(&name, seen.frame)?;
        let (pedestrian, word) = self.numbered(seen.pedestrian);
        let (line, limit) = (self.lines.number(), LARGEST_CROWD);
        let scene = self.scenes.entry(name.clone()).or_insert_with(SceneProgress::unseen);
        let growing = scene.current.as_ref();
        if let Some(&first_line) = growing.and_then(|growing| growing.lines.get(&pedestrian)) {
            let name = word.map(|word| PedestrianName::Word(word.to_string())).unwrap_or(pedestrian.into());
            return Err(duplicate(name, (seen.frame, seen.unit), first_line).into());
        }
        // A returned frame makes room for a pedestrian.
        if self.unfinished == limit {
            let frames = match name {
                None => when(seen.frame, seen.unit),
                Some(scene) => {
                    format!("the incomplete frames, one of them {} of scene {scene}", when(seen.frame, seen.unit))
                }
            };
            let problem = format!("more than {limit} pedestrians in {frames}; does the frame number increase?");
            return Err(problem.into());
        }
        let is_first = scene.last.is_none();
        let growing = scene.current.get_or_insert_with(|| Growing {
            frame: Frame {
                scene: name,
                is_first,
                number: seen.frame,
                pedestrians: Vec::new(),
                names: PedestrianNames::default(),
            },
            lines: BTreeMap::new(),
            words: BTreeMap::new(),
        });
        growing.words.extend(word.map(|word| (pedestrian, word)));
        growing.lines.insert(pedestrian, line);
        growing.frame.pedestrians.push((pedestrian, seen.position));
        self.unfinished += 1;
        Ok(before)
    }

    /// Checks that the frame is not before the last one of the scene. If it is a new one, returns the previous frame.
    fn begin_frame(&mut self, name: &Option<SceneName>, frame: i64) -> Result<Option<Frame>, Fault> {
        let unit = self.time_unit();
        let scene = self.scenes.entry(name.clone()).or_insert_with(SceneProgress::unseen);
        let reached = scene.current.as_ref().map(|growing| growing.frame.number);
        if let Some(last) = reached.or(scene.last)
            && (frame < last || (reached.is_none() && frame == last))
        {
            let of_scene = name.as_ref().map_or_else(String::new, |scene| format!(" of scene {scene}"));
            let (now, last) = (when(frame, unit), when(last, unit));
            let order = "a stream of tracks must be in order of time";
            return Err(format!("{now}{of_scene} comes after {last}; {order}").into());
        }
        Ok(if reached == Some(frame) { None } else { self.take_frame(name) })
    }

    /// Refuses a stream in which only some lines name a scene, or whose times change their kind.
    fn refuse_mixed(&mut self, row: &TrackRow) -> Result<(), Fault> {
        let (is_named, unit, line) = (row.scene.is_some(), row.unit, self.lines.number());
        let first = *self.first.get_or_insert(FirstRow { is_named, unit, line });
        if first.unit != unit {
            return Err(MIXED_TIMES.into());
        }
        if first.is_named == is_named {
            return Ok(());
        }
        let first_line = first.line;
        let here = if is_named { "a scene is named here, but not" } else { "track.scene is missing here, but present" };
        Err(format!("{here} on line {first_line}; name the scene of every observation or omit it everywhere").into())
    }

    /// Makes room for a new scene, and forgets idle scenes.
    fn note_activity(&mut self, name: &Option<SceneName>) -> Result<(), Fault> {
        let idle_timeout = self.idle_timeout;
        match self.scenes.get_mut(name) {
            Some(scene) if name.is_none() || scene.heard.elapsed() < idle_timeout => {
                scene.heard = Instant::now();
                return Ok(());
            }
            _ => {}
        }
        let idle = |scene: &SceneProgress| scene.heard.elapsed() >= idle_timeout;
        let idle: Vec<_> = self.scenes.iter().filter(|(_, scene)| idle(scene)).map(|(name, _)| name.clone()).collect();
        for name in idle {
            let frame = self.take_frame(&name);
            self.left.extend(frame);
            self.scenes.remove(&name);
        }
        if let Some(scene) = name
            && self.scenes.len() == MOST_SCENES
        {
            let minutes = idle_timeout.as_secs() / 60;
            return Err(format!(
                "scene {scene} exceeds the limit of {MOST_SCENES} scenes; a scene is forgotten after {minutes} minutes \
                 without a line; give the other scenes to another reader"
            )
            .into());
        }
        Ok(())
    }

    /// The number of a pedestrian, and its name if it is a word.
    fn numbered(&mut self, who: PedestrianName) -> (PedestrianId, Option<Arc<str>>) {
        match who {
            PedestrianName::Number(number) => (PedestrianId(number), None),
            PedestrianName::Word(word) => {
                let (id, word) = self.words.number(&word);
                (id, Some(word))
            }
        }
    }

    /// Takes the frame of the scene as read so far.
    fn take_frame(&mut self, name: &Option<SceneName>) -> Option<Frame> {
        let scene = self.scenes.get_mut(name)?;
        let growing = scene.current.take()?;
        scene.last = Some(growing.frame.number);
        self.unfinished -= growing.frame.pedestrians.len();
        Some(Frame { names: PedestrianNames::new(growing.words), ..growing.frame })
    }
}
