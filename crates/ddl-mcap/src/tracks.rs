//! The tracks of a topic, as a recording.

use crate::decode::{Decoded, READ, decode, may_hold_tracks, type_name};
use crate::error::LogError;
use crate::files::files;
use crate::messages::{Channel, Message, Messages, seconds};
use ddl_core::{FRAME_LIMIT, PedestrianId};
use ddl_data::{COORDINATE_LIMIT, Numbering, Observation, Recording, RecordingError, TimeUnit};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Topics that an error lists.
const MOST_LISTED: usize = 20;

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
    /// The coordinate frame of its positions; may be empty.
    pub(crate) frame_id: String,
}

/// Reads the tracks of an MCAP file, or of the folder of a rosbag2 recording: those of `topic` or, without it, of the
/// one topic that holds tracks. `keep` chooses the classes that are pedestrians.
///
/// Messages have the time of their header, or that of the log where they have none. Of a file whose end is missing,
/// the whole chunks are read.
///
/// # Errors
/// If files cannot be read; if a message of the topic, or what leads to it, is damaged or of an unknown kind; if no
/// topic or several hold tracks.
pub fn read_log(path: &Path, topic: Option<&str>, keep: impl Fn(&str) -> bool) -> Result<LoggedTracks, LogError> {
    let files = files(path)?;
    let mut topics: BTreeMap<String, Topic> = BTreeMap::new();
    let mut notes = Vec::new();
    for file in &files {
        let mut messages = Messages::open(file, is_wanted, topic)?;
        while let Some(message) = messages.next()? {
            let place = place(file, &message);
            let decoded = decode(&message).map_err(|problem| LogError::at(&place, problem))?;
            if let Some(decoded) = decoded {
                let topic = topics.entry(message.channel.topic.clone()).or_default();
                topic
                    .tracks
                    .add(decoded, &keep)
                    .map_err(|problem| LogError::at(&place, problem))?;
            }
        }
        for (channel, count) in messages.channels() {
            topics.entry(channel.topic.clone()).or_default().tell(channel, count);
        }
        if messages.is_cut {
            notes.push(format!(
                "{} is cut off: read is what is whole, until {} s of its log",
                file.display(),
                seconds(messages.time())
            ));
        }
    }
    let origin = path.display().to_string();
    let (name, chosen) = choose(topics, topic).map_err(|problem| LogError::at(&origin, problem))?;
    notes.insert(0, chosen.words(&name));
    notes.extend(chosen.tracks.left_out());
    let frame_id = chosen.tracks.frame_id.clone().unwrap_or_default();
    let recording = chosen.tracks.recording(&origin);
    let recording = recording.map_err(|problem| LogError::at(format!("{origin}, topic {name}"), problem))?;
    Ok(LoggedTracks {
        recording: recording.with_notes(notes),
        topic: TrackTopic { files, name, frame_id },
    })
}

fn is_wanted(channel: &Channel, topic: Option<&str>) -> bool {
    may_hold_tracks(channel) && topic.is_none_or(|topic| topic == channel.topic)
}

pub(crate) fn place(file: &Path, message: &Message) -> String {
    let Message {
        channel,
        sequence,
        log_time,
        ..
    } = message;
    let (file, topic, time) = (file.display(), &channel.topic, seconds(*log_time));
    format!("{file}, topic {topic}, message {sequence} at {time} s")
}

/// What is known of a topic.
#[derive(Debug, Default)]
struct Topic {
    kind: String,
    messages: u64,
    tracks: Tracks,
}

impl Topic {
    fn tell(&mut self, channel: &Channel, count: u64) {
        self.kind = match (&*type_name(channel), &channel.encoding) {
            ("", encoding) => encoding.clone(),
            (kind, encoding) => format!("{kind} as {encoding}"),
        };
        self.messages += count;
    }

    fn words(&self, name: &str) -> String {
        let of = match &self.tracks.frame_id {
            Some(frame) if !frame.is_empty() => format!(", positions in the frame {frame}"),
            _ => String::new(),
        };
        let times = if self.tracks.is_logged == Some(true) {
            "those of the log, as the messages have none"
        } else {
            "those of the messages"
        };
        format!(
            "topic {name} ({}, {} messages) is read{of}; times are {times}",
            self.kind, self.messages
        )
    }
}

/// The topic that was asked for, or the one with tracks.
fn choose(mut topics: BTreeMap<String, Topic>, asked: Option<&str>) -> Result<(String, Topic), String> {
    let listed = |some: Vec<(&String, &Topic)>| {
        let more = some.len().saturating_sub(MOST_LISTED);
        let some = some.iter().take(MOST_LISTED);
        let words = some.map(|(name, topic)| format!("{name} ({}, {} messages)", topic.kind, topic.messages));
        let more = (more > 0).then(|| format!("{more} more"));
        words.chain(more).collect::<Vec<_>>().join(", ")
    };
    let all = || listed(topics.iter().collect());
    let found: Vec<(&String, &Topic)> = topics
        .iter()
        .filter(|(_, topic)| topic.tracks.is_logged.is_some())
        .collect();
    let name = match (asked, &found[..]) {
        (_, [(name, _)]) => (*name).clone(),
        (_, []) if topics.is_empty() => return Err("the file holds no topic".to_owned()),
        (Some(asked), _) => match topics.get(asked) {
            Some(topic) => {
                return Err(format!(
                    "topic {asked} holds no tracks but {}; read is {READ}",
                    topic.kind
                ));
            }
            None => return Err(format!("there is no topic {asked} among {}", all())),
        },
        (None, []) => return Err(format!("no topic holds tracks among {}; read is {READ}", all())),
        (None, _) => {
            return Err(format!(
                "several topics hold tracks; choose one with --topic: {}",
                listed(found)
            ));
        }
    };
    let topic = topics.remove(&name).unwrap_or_default();
    Ok((name, topic))
}

/// The rows of a topic so far.
#[derive(Debug, Default)]
struct Tracks {
    rows: Vec<Observation>,
    numbering: Option<Numbering>,
    words: BTreeMap<PedestrianId, Arc<str>>,
    frame_id: Option<String>,
    /// Whether the times are those of the log; `None` before the first message.
    is_logged: Option<bool>,
    occluded: usize,
    /// Rows of other classes.
    others: BTreeMap<String, usize>,
}

impl Tracks {
    fn add(&mut self, decoded: Decoded, keep: impl Fn(&str) -> bool) -> Result<(), String> {
        let Decoded {
            microseconds,
            is_logged,
            mut observed,
        } = decoded;
        if *self.is_logged.get_or_insert(is_logged) != is_logged {
            return Err("header.stamp is 0 in some messages and a time in others".to_owned());
        }
        let frame_id = self.frame_id.get_or_insert_with(|| observed.header.frame_id.clone());
        if *frame_id != observed.header.frame_id {
            let other = &observed.header.frame_id;
            return Err(format!(
                "positions in the frame {other:?}, but before in {frame_id:?}; record them in one frame"
            ));
        }
        self.occluded += observed.occluded;
        observed.pedestrians.retain(|seen| {
            let is_kept = keep(&seen.class);
            if !is_kept {
                *self.others.entry(seen.class.clone()).or_default() += 1;
            }
            is_kept
        });
        let numbering = self.numbering.get_or_insert_with(|| Numbering::remembering(usize::MAX));
        let (seen, names) = observed.numbered(numbering);
        let mut present = BTreeSet::new();
        for (id, position) in seen {
            if !present.insert(id) {
                return Err(format!("pedestrian {} is in the message twice", names.of(id)));
            }
            if position.iter().any(|c| c.abs() > COORDINATE_LIMIT) {
                return Err(format!("pedestrian {} is at {position:?}, beyond 1e7 m", names.of(id)));
            }
            if id.0 >= FRAME_LIMIT {
                self.words.entry(id).or_insert_with(|| names.of(id).to_string().into());
            }
            self.rows.push(Observation::new(microseconds, id, position));
        }
        Ok(())
    }

    fn left_out(&self) -> Option<String> {
        let others = self
            .others
            .iter()
            .map(|(class, count)| format!("{count} of class {class}"));
        let occluded = (self.occluded > 0).then(|| format!("{} that are occluded", self.occluded));
        let all: Vec<String> = others.chain(occluded).collect();
        (!all.is_empty()).then(|| format!("rows left out: {}", all.join(", ")))
    }

    fn recording(self, origin: &str) -> Result<Recording, String> {
        let words = self.words;
        let recording = Recording::in_usual_step(origin, self.rows).map_err(|error| match error {
            RecordingError::Duplicate { pedestrian, frame } => {
                let name = words
                    .get(&pedestrian)
                    .map_or_else(|| pedestrian.to_string(), ToString::to_string);
                let time = frame as f64 / 1e6;
                format!("pedestrian {name} is at two places at the time {time} s; the times must differ")
            }
            other => other.to_string(),
        });
        Ok(recording?.with_words(words).with_time_unit(Some(TimeUnit::Seconds)))
    }
}
