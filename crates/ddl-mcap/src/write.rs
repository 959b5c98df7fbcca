//! Forecasts as MCAP.

use crate::decode::decode;
use crate::error::{LogError, LogProblem};
use crate::messages::Messages;
use crate::tracks::TrackTopic;
use ddl_core::{Forecast, Window};
use ddl_ros::msg::{Header, Time};
use ddl_ros::{ForecastMessages, definition};
use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{WriteOptions, Writer};
use std::collections::BTreeMap;
use std::io::Write;

/// The coordinate frame where the tracks name none: the fixed one of ROS.
const FIXED_FRAME: &str = "map";

/// A log that is written: all forecasts as `ddl_msgs/Forecasts` on the topic `/ddl/forecasts`, a picture of them
/// (`visualization_msgs/MarkerArray`) on `/ddl/markers`, the likeliest path of each pedestrian (`nav_msgs/Path`) on
/// `/ddl/paths`, and the messages with the tracks as they are. The log time of a message is its moment.
///
/// Chunks are not compressed, as the crate `mcap` does that by libraries in C alone.
#[expect(missing_debug_implementations, reason = "the writer of `mcap` has none")]
pub struct ForecastLog<W: Write> {
    writer: Writer<NoSeek<W>>,
    frame_id: Option<String>,
}

impl<W: Write> ForecastLog<W> {
    /// Begins the log with the messages of `tracks`.
    ///
    /// # Errors
    /// It cannot be written, or the messages cannot be read again.
    pub fn new(to: W, tracks: Option<&TrackTopic>) -> Result<Self, LogError> {
        let options = WriteOptions::new().profile("ros2").disable_seeking(true);
        let mut log = Self {
            writer: options.create(NoSeek::new(to))?,
            frame_id: tracks.and_then(|tracks| tracks.frame_id.clone()),
        };
        for file in tracks.iter().flat_map(|tracks| &tracks.files) {
            let here = |problem: LogProblem| problem.at(file.display());
            let mut messages = Messages::open(file).map_err(here)?;
            while let Some(message) = messages.next().map_err(here)? {
                let channel = &message.channel;
                if tracks.is_some_and(|tracks| tracks.name == channel.topic)
                    && let Some((time, _)) = decode(&message).map_err(here)?
                {
                    let schema = channel.schema.as_ref();
                    let schema =
                        schema.map(|schema| log.writer.add_schema(&schema.name, &schema.encoding, &schema.data));
                    let (schema, metadata) = (schema.transpose()?.unwrap_or(0), &channel.metadata);
                    let id = log.writer.add_channel(schema, &channel.topic, &channel.message_encoding, metadata)?;
                    let header = MessageHeader {
                        channel_id: id,
                        sequence: message.sequence,
                        log_time: time.map_or(Ok(message.log_time), nanoseconds)?,
                        publish_time: message.publish_time,
                    };
                    log.writer.write_to_known_channel(&header, &message.data)?;
                }
            }
        }
        Ok(log)
    }

    /// The coordinate frame of the forecasts, if it is assumed because the tracks name none.
    pub fn assumed_frame(&self) -> Option<&'static str> {
        self.frame_id.is_none().then_some(FIXED_FRAME)
    }

    /// Writes the forecast of a moment; `joint`: hypothesis k of all pedestrians is one future of the scene.
    ///
    /// # Errors
    /// It cannot be written, or the moment is before 0.
    pub fn add(
        &mut self,
        window: &Window,
        forecast: &Forecast,
        joint: bool,
        microseconds: i64,
    ) -> Result<(), LogError> {
        let stamp = Time::of_microseconds(microseconds);
        let header = &Header { stamp, frame_id: self.frame_id.as_deref().unwrap_or(FIXED_FRAME).to_owned() };
        let moment = ForecastMessages { window, forecast, header, joint };
        let time = nanoseconds(microseconds)?;
        self.put("/ddl/forecasts", &moment.forecasts(), time)?;
        self.put("/ddl/markers", &moment.markers(), time)?;
        for path in moment.likeliest_paths() {
            self.put("/ddl/paths", &path, time)?;
        }
        Ok(())
    }

    /// Ends the log.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn finish(mut self) -> Result<(), LogError> {
        self.writer.finish()?;
        Ok(())
    }

    fn put<M: ddl_ros::Message>(&mut self, topic: &str, message: &M, time: u64) -> Result<(), LogError> {
        let definition = definition(M::TYPE).unwrap_or_default();
        let schema = self.writer.add_schema(M::TYPE, "ros2msg", definition.as_bytes())?;
        let header = MessageHeader {
            channel_id: self.writer.add_channel(schema, topic, "cdr", &BTreeMap::new())?,
            sequence: 0,
            log_time: time,
            publish_time: time,
        };
        Ok(self.writer.write_to_known_channel(&header, &ddl_ros::write(message)?)?)
    }
}

fn nanoseconds(microseconds: i64) -> Result<u64, LogError> {
    u64::try_from(microseconds).ok().and_then(|time| time.checked_mul(1000)).ok_or(LogError::Early { microseconds })
}
