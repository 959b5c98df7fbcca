//! The tracks of a topic, as a recording.

use crate::decode::{Decoded, READ, decode, type_name};
use crate::error::{LogError, LogProblem};
use crate::files::files;
use crate::messages::Messages;
use ddl_core::{COORDINATE_LIMIT, FRAME_LIMIT, Numbering, PedestrianId, Setting};
use ddl_data::{LiveError, LiveTracks, Observation, Recording, RecordingError, TimeUnit, escaped};
use mcap::Channel;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Topics and classes that are listed.
const MOST_LISTED: usize = 20;
/// Bytes of a pedestrian's name.
const LONGEST_NAME: usize = 256;

/// The tracks of a log.
#[derive(Debug)]
pub struct LoggedTracks {
    /// Its frame numbers are times in microseconds; its notes tell what was chosen, assumed and left out.
    pub recording: Recording,
    /// Where they are from.
    pub topic: TrackTopic,
}

/// A topic with tracks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TrackTopic {
    pub(crate) files: Vec<PathBuf>,
    pub(crate) name: String,
    /// The coordinate frame of the positions; `None` if the messages name none.
    pub frame_id: Option<String>,
}

/// Reads the tracks of an MCAP file, or of the folder of a rosbag2 recording: those of the topic that is `asked` for
/// or, without it, of the one topic that holds tracks. `keep` chooses the classes that are pedestrians.
///
/// Messages have the time of their header, or that of the log where they have none. Of a file whose end is missing,
/// the whole chunks are read.
///
/// # Errors
/// A file cannot be read; a message of the topic, or what leads to it, is damaged or of an unknown kind; no topic or
/// several hold tracks.
pub fn read_log(path: &Path, asked: Option<&str>, keep: impl Fn(&str) -> bool) -> Result<LoggedTracks, LogError> {
    let (files, note) = files(path)?;
    let (mut topics, mut notes) = (BTreeMap::<String, Topic>::new(), Vec::from_iter(note));
    for file in &files {
        let (file_name, mut time) = (file.display(), 0.0);
        let mut messages = Messages::open(file).map_err(|problem| problem.at(&file_name))?;
        while let Some(message) =
            messages.next().map_err(|problem| problem.at(format!("{file_name}, after {time:.6} s")))?
        {
            time = message.log_time as f64 / 1e9;
            let channel = &message.channel;
            let topic = topics.entry(channel.topic.clone()).or_insert_with(|| Topic::of(channel));
            topic.messages += 1;
            if asked.is_none_or(|asked| asked == channel.topic) {
                let decoded = decode(&message);
                decoded.and_then(|decoded| topic.add(decoded, message.log_time, &keep)).map_err(|problem| {
                    let hint = || format!("{problem}; {} reads another topic", Setting::Topic).into();
                    let problem = if asked.is_none() { hint() } else { problem };
                    let (topic, number) = (&channel.topic, message.sequence);
                    problem.at(format!("{file_name}, topic {topic}, message {number} at {time:.6} s"))
                })?;
            }
        }
        if messages.is_cut {
            notes.push(format!("{file_name} is cut off: what is whole was read, until {time:.6} s"));
        }
    }
    let (name, topic) = choose(topics, asked).map_err(|problem| problem.at(path.display()))?;
    let words = topic.description(&name);
    if topic.rows.is_empty() {
        let keep = Setting::Keep.to("class=NAME");
        let problem = LogProblem::from(format!("{words}; no row is left, and {keep} chooses another class"));
        return Err(problem.at(path.display()));
    }
    notes.insert(0, words);
    let frame_id = topic.frame_id.clone().filter(|frame_id| !frame_id.is_empty());
    let recording = topic.recording().map_err(|problem| problem.at(format!("{}, topic {name}", path.display())))?;
    Ok(LoggedTracks {
        recording: recording.with_notes(notes.iter().map(|note| escaped(note)).collect()),
        topic: TrackTopic { files, name, frame_id },
    })
}

/// The topic that was asked for, or the one with tracks.
fn choose(mut topics: BTreeMap<String, Topic>, asked: Option<&str>) -> Result<(String, Topic), LogProblem> {
    let listed = |wanted: fn(&Topic) -> bool| {
        let some = topics.iter().filter(|(_, topic)| wanted(topic)).take(MOST_LISTED);
        let some = some.map(|(name, topic)| format!("{name} ({}, {} messages)", topic.kind, topic.messages));
        some.collect::<Vec<_>>().join(", ")
    };
    let holds_tracks = |topic: &Topic| topic.is_logged.is_some();
    let mut found = topics.iter().filter(|(_, topic)| holds_tracks(topic)).map(|(name, _)| name.clone());
    match (asked, found.next(), found.next()) {
        (_, Some(name), None) => Ok(topics.remove_entry(&name).unwrap_or_default()),
        (None, Some(_), _) => {
            Err(format!("several topics hold tracks, choose one ({}): {}", Setting::Topic, listed(holds_tracks)).into())
        }
        _ if topics.is_empty() => Err("there is no message; is the file empty or cut off?".into()),
        (None, None, _) => Err(format!("no tracks in {}; read is {READ}", listed(|_| true)).into()),
        (Some(asked), ..) => Err(match topics.get(asked) {
            Some(topic) => format!("topic {asked} holds no tracks but {}; read is {READ}", topic.kind).into(),
            None => format!("no message of topic {asked}; there are {}", listed(|_| true)).into(),
        }),
    }
}

/// What is known of a topic.
#[derive(Debug, Default)]
struct Topic {
    kind: String,
    messages: u64,
    rows: Vec<Observation>,
    /// How often the times go back by more than a gap in a track.
    restarts: usize,
    numbering: Option<Numbering>,
    words: BTreeMap<PedestrianId, Arc<str>>,
    frame_id: Option<String>,
    /// Whether the times are those of the log; `None` without tracks.
    is_logged: Option<bool>,
    left_out: BTreeMap<String, usize>,
    /// The first classes that were read.
    classes: BTreeSet<String>,
}

impl Topic {
    fn of(channel: &Channel<'_>) -> Self {
        Self { kind: format!("{} as {}", type_name(channel), channel.message_encoding), ..Self::default() }
    }

    fn description(&self, name: &str) -> String {
        let (kind, messages, frame_id) = (&self.kind, self.messages, self.frame_id.as_deref().unwrap_or_default());
        let logged = if self.is_logged == Some(true) { "of the log" } else { "of the messages" };
        let left_out = self.left_out.iter().map(|(what, count)| format!("; {count} rows left out: {what}"));
        let left_out: String = left_out.collect();
        let classes: Vec<&str> = self.classes.iter().map(String::as_str).collect();
        let classes = match &classes[..] {
            [] => String::new(),
            classes => format!(", classes read {}", classes.join(", ")),
        };
        format!(
            "topic {name} ({kind}, {messages} messages): times {logged}, positions in the frame \
             {frame_id:?}{classes}{left_out}"
        )
    }

    /// Adds the rows of a message.
    fn add(&mut self, decoded: Option<Decoded>, log_time: u64, keep: impl Fn(&str) -> bool) -> Result<(), LogProblem> {
        let Some((time, mut observed)) = decoded else { return Ok(()) };
        if *self.is_logged.get_or_insert(time.is_none()) != time.is_none() {
            return Err("header.stamp is 0 in some messages and a time in others".into());
        }
        let frame_id = self.frame_id.get_or_insert_with(|| observed.header.frame_id.clone());
        if *frame_id != observed.header.frame_id {
            let other = &observed.header.frame_id;
            let before = format!("positions in the frame {other:?}, but before in {frame_id:?}");
            return Err(format!("{before}; record them in one").into());
        }
        for (reason, count) in &observed.left_out {
            *self.left_out.entry((*reason).to_owned()).or_default() += count;
        }
        observed.pedestrians.retain_mut(|seen| {
            seen.name = escaped(&seen.name);
            let is_kept = keep(&seen.class);
            if !is_kept {
                *self.left_out.entry(format!("class {}", seen.class)).or_default() += 1;
            } else if !seen.class.is_empty() && self.classes.len() < MOST_LISTED {
                self.classes.insert(seen.class.clone());
            }
            is_kept
        });
        let time = time.unwrap_or((log_time / 1000) as i64);
        let last = self.rows.last().map_or(time, |row| row.frame);
        self.restarts += usize::from(last.saturating_sub(time) as f64 / 1e6 > LiveTracks::LONGEST_GAP);
        let (seen, names) = observed.numbered(self.numbering.get_or_insert_with(|| Numbering::remembering(usize::MAX)));
        for (id, position) in seen {
            let name = names.of(id).to_string();
            if name.len() > LONGEST_NAME || position.iter().any(|c| c.abs() > COORDINATE_LIMIT) {
                return Err(format!("pedestrian {name} at {position:?}: beyond 256 bytes or 1e7 m").into());
            }
            if id.0 >= FRAME_LIMIT {
                self.words.entry(id).or_insert_with(|| name.into());
            }
            self.rows.push(Observation::new(time, id, position));
        }
        Ok(())
    }

    fn recording(self) -> Result<Recording, LogProblem> {
        let recording = Recording::in_usual_step("log", self.rows).map_err(|error| match error {
            RecordingError::Row(LiveError::Duplicate { pedestrian, frame }) => {
                let name = self.words.get(&pedestrian).map_or_else(|| pedestrian.to_string(), ToString::to_string);
                let time = frame as f64 / 1e6;
                format!("pedestrian {name} is there twice at {time:.6} s; record one tracker to a topic").into()
            }
            other => LogProblem::from(other),
        });
        Ok(recording?.with_words(self.words).with_restarts(self.restarts).with_time_unit(Some(TimeUnit::Seconds)))
    }
}
