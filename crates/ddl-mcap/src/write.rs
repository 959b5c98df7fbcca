//! Forecasts as MCAP.

use crate::decode::decode;
use crate::error::LogError;
use crate::messages::{Channel, Message, Messages};
use crate::tracks::{TrackTopic, place};
use ddl_core::{Forecast, Window};
use ddl_ros::msg::{Header, Time};
use ddl_ros::{Moment, definition, write};
use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{WriteOptions, Writer};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;
use std::vec;

/// The coordinate frame where the tracks name none: the fixed one of ROS.
const FIXED_FRAME: &str = "map";

/// A log that is written: all forecasts as `ddl_msgs/Forecasts` on the topic `/forecasts`, a picture of them
/// (`visualization_msgs/MarkerArray`) on `/forecasts/markers`, the likeliest path of each pedestrian (`nav_msgs/Path`)
/// on `/forecasts/path/NAME`, and the messages with the tracks as they are. The log time of a message is its moment.
///
/// Chunks are not compressed: nearly all bytes are digits of positions, which do not pack.
#[expect(missing_debug_implementations, reason = "the writer of `mcap` has none")]
pub struct ForecastLog<W: Write> {
    writer: Writer<NoSeek<W>>,
    tracks: Option<Copied>,
    frame_id: String,
    sequences: BTreeMap<u16, u32>,
}

impl<W: Write> ForecastLog<W> {
    /// Begins the log. The messages of `tracks` will be copied.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn new(to: W, tracks: Option<&TrackTopic>) -> Result<Self, LogError> {
        let options = WriteOptions::new().profile("ros2").disable_seeking(true);
        let frame_id = tracks
            .map(|tracks| tracks.frame_id.clone())
            .filter(|frame_id| !frame_id.is_empty());
        Ok(Self {
            writer: options.create(NoSeek::new(to))?,
            tracks: tracks.map(Copied::new),
            frame_id: frame_id.unwrap_or_else(|| FIXED_FRAME.to_owned()),
            sequences: BTreeMap::new(),
        })
    }

    /// Writes the forecast of a moment; `joint`: hypothesis k of all pedestrians is one future of the scene. Moments
    /// come in order of time.
    ///
    /// # Errors
    /// If it cannot be written, the moment is before 0, or the messages with the tracks cannot be read again.
    pub fn add(
        &mut self,
        window: &Window,
        forecast: &Forecast,
        joint: bool,
        microseconds: i64,
    ) -> Result<(), LogError> {
        self.copy_until(microseconds)?;
        let moment = Moment {
            window,
            forecast,
            joint,
            header: &Header {
                stamp: Time::of_microseconds(microseconds),
                frame_id: self.frame_id.clone(),
            },
        };
        self.put("/forecasts", &moment.forecasts(), microseconds)?;
        self.put("/forecasts/markers", &moment.markers(), microseconds)?;
        for (i, path) in moment.likeliest_paths().iter().enumerate() {
            self.put(&format!("/forecasts/path/{}", window.name(i)), path, microseconds)?;
        }
        Ok(())
    }

    /// Ends the log.
    ///
    /// # Errors
    /// As [`add`](Self::add).
    pub fn finish(mut self) -> Result<(), LogError> {
        self.copy_until(i64::MAX)?;
        self.writer.finish()?;
        Ok(())
    }

    fn put<M: ddl_ros::Message>(&mut self, topic: &str, message: &M, microseconds: i64) -> Result<(), LogError> {
        let definition = definition(M::TYPE).unwrap_or_default();
        let schema = self.writer.add_schema(M::TYPE, "ros2msg", definition.as_bytes())?;
        let channel = self.writer.add_channel(schema, topic, "cdr", &BTreeMap::new())?;
        let time = nanoseconds(microseconds)?;
        self.write(channel, time, time, &write(message)?)
    }

    fn write(&mut self, channel_id: u16, log_time: u64, publish_time: u64, data: &[u8]) -> Result<(), LogError> {
        let sequence = self.sequences.entry(channel_id).or_default();
        let header = MessageHeader {
            channel_id,
            sequence: *sequence,
            log_time,
            publish_time,
        };
        *sequence = sequence.wrapping_add(1);
        Ok(self.writer.write_to_known_channel(&header, data)?)
    }

    /// Copies the messages with tracks up to a moment.
    fn copy_until(&mut self, microseconds: i64) -> Result<(), LogError> {
        while let Some(tracks) = &mut self.tracks {
            let Some((time, message)) = tracks.next_until(microseconds)? else {
                break;
            };
            let Channel {
                topic,
                encoding,
                metadata,
                schema,
            } = &*message.channel;
            let schema = match schema {
                Some(schema) => self.writer.add_schema(&schema.name, &schema.encoding, &schema.data)?,
                None => 0,
            };
            let channel = self.writer.add_channel(schema, topic, encoding, metadata)?;
            self.write(channel, nanoseconds(time)?, message.publish_time, &message.data)?;
        }
        Ok(())
    }
}

fn nanoseconds(microseconds: i64) -> Result<u64, LogError> {
    let time = u64::try_from(microseconds).ok().and_then(|time| time.checked_mul(1000));
    time.ok_or(LogError::Early { microseconds })
}

/// The messages with tracks, which are read again while forecasts are written.
struct Copied {
    topic: String,
    files: vec::IntoIter<PathBuf>,
    file: Option<(PathBuf, Messages)>,
    waiting: Option<(i64, Message)>,
}

impl Copied {
    fn new(tracks: &TrackTopic) -> Self {
        Self {
            topic: tracks.name.clone(),
            files: tracks.files.clone().into_iter(),
            file: None,
            waiting: None,
        }
    }

    /// The next message with its time, if that is not after the moment.
    fn next_until(&mut self, microseconds: i64) -> Result<Option<(i64, Message)>, LogError> {
        if self.waiting.is_none() {
            self.waiting = self.next()?;
        }
        Ok(self.waiting.take_if(|(time, _)| *time <= microseconds))
    }

    fn next(&mut self) -> Result<Option<(i64, Message)>, LogError> {
        loop {
            let Some((path, messages)) = &mut self.file else {
                let Some(path) = self.files.next() else {
                    return Ok(None);
                };
                let wanted = |channel: &Channel, topic: Option<&str>| topic == Some(channel.topic.as_str());
                let messages = Messages::open(&path, wanted, Some(&self.topic))?;
                self.file = Some((path, messages));
                continue;
            };
            let Some(message) = messages.next()? else {
                self.file = None;
                continue;
            };
            let place = place(path, &message);
            let decoded = decode(&message).map_err(|problem| LogError::at(place, problem))?;
            if let Some(decoded) = decoded {
                return Ok(Some((decoded.microseconds, message)));
            }
        }
    }
}
