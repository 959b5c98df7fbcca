//! From a message to the pedestrians in it.

use crate::error::LogProblem;
use ddl_data::FrameReader;
use ddl_ros::msg::{Detection3DArray, Header, People, Point, Time, TrackedPersons};
use ddl_ros::{Message as _, Observed, RosError, SeenPedestrian, read_tracks};
use mcap::{Channel, Message};
use serde_json::Value;

/// Types of ROS messages with tracks; where JSON has their list of pedestrians, and in each its name and position.
const TYPES: [[&str; 4]; 3] = [
    [Detection3DArray::TYPE, "detections", "/id", "/bbox/center/position"],
    [People::TYPE, "people", "/name", "/position"],
    [TrackedPersons::TYPE, "tracks", "/track_id", "/pose/pose/position"],
];
const TRACK: &[u8] = b"\"track\"";

/// What is read, for messages to users.
pub(crate) const READ: &str = "vision_msgs/Detection3DArray, people_msgs/People or \
    spencer_tracking_msgs/TrackedPersons as cdr or json, and json of {\"track\": {\"p\": 1, \"x\": 2.0, \"y\": 3.0}}";

/// Microseconds of the message itself, and the pedestrians.
pub(crate) type Decoded = (Option<i64>, Observed);

/// The type of a channel as ROS 2 writes it.
pub(crate) fn type_name(channel: &Channel<'_>) -> String {
    let name = channel.schema.as_ref().map_or("", |schema| &schema.name);
    match name.split_once('/') {
        Some((package, message)) if !message.contains('/') => format!("{package}/msg/{message}"),
        _ => name.to_owned(),
    }
}

/// The pedestrians; `None` if the message is of a kind without tracks.
pub(crate) fn decode(message: &Message<'_>) -> Result<Option<Decoded>, LogProblem> {
    let (bytes, name) = (&*message.data, type_name(&message.channel));
    let layout = TYPES.iter().find(|[known, ..]| *known == name);
    match (&*message.channel.message_encoding, layout) {
        ("cdr", Some(_)) => match read_tracks(&name, bytes) {
            // A time stands in for the one that is missing, in the first field.
            Err(RosError::NoTime { .. }) => {
                let stamped = [&bytes[..4], &[1], &bytes[5..]].concat();
                read_tracks(&name, &stamped).map(|observed| Some((None, observed)))
            }
            read => read.map(|observed| Some((Some(observed.header.stamp.microseconds()), observed))),
        }
        .map_err(LogProblem::from),
        ("json", Some(layout)) => of_json(bytes, layout).map(Some),
        ("json", None) => of_lines(bytes),
        _ => Ok(None),
    }
}

/// A ROS message as JSON; of its fields those that are needed.
fn of_json(bytes: &[u8], [_, list, name, position]: &[&str; 4]) -> Result<Decoded, LogProblem> {
    let message: Value = serde_json::from_slice(bytes)?;
    let items = message[*list].as_array().ok_or_else(|| format!("there is no list `{list}`"))?;
    let frame_id = |of: &Value| of["header"]["frame_id"].as_str().unwrap_or_default().to_owned();
    let seen = items.iter().map(|item| {
        let is_occluded = item["is_occluded"] == true;
        let coordinate = |axis| match item.pointer(position).and_then(|place| place.get(axis)) {
            None if !is_occluded => None,
            number => Some(number.and_then(Value::as_f64).unwrap_or(f64::NAN)),
        };
        let name = item.pointer(name).filter(|name| name.is_number() || name.as_str().is_some_and(|it| !it.is_empty()));
        let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let class = |result: &Value| result.pointer("/hypothesis/class_id").filter(|class| !class.is_null()).map(text);
        let score = |result: &&Value| result["hypothesis"]["score"].as_f64().unwrap_or(0.0);
        let likeliest = item["results"].as_array().into_iter().flatten().max_by(|a, b| score(a).total_cmp(&score(b)));
        Some(SeenPedestrian {
            name: name.map(text)?,
            class: likeliest.and_then(class).unwrap_or_default(),
            position: Point::from([coordinate("x")?, coordinate("y")?]),
            frame_id: frame_id(item),
            is_occluded,
        })
    });
    let missing = || format!("each of `{list}` needs {name}, and x and y of {position} (m)");
    let pedestrians = seen.collect::<Option<_>>().ok_or_else(missing)?;
    let stamp = &message["header"]["stamp"];
    // As ROS 2, Foxglove and ROS 1 call them.
    let seconds = part_of(stamp, &["sec", "secs"])?;
    let nanoseconds = part_of(stamp, &["nanosec", "nsec", "nsecs"])?;
    let microseconds = seconds.saturating_mul(1_000_000).saturating_add(nanoseconds / 1000);
    let header = Header { stamp: Time::of_microseconds(microseconds), frame_id: frame_id(&message) };
    Ok(((microseconds != 0).then_some(microseconds), Observed::new(header, pedestrians)))
}

/// The whole number with one of these names, which may be a text as protobuf writes it; 0 without any.
fn part_of(stamp: &Value, names: &[&str]) -> Result<i64, LogProblem> {
    let Some((name, value)) = names.iter().find_map(|name| Some((name, stamp.get(name)?))) else { return Ok(0) };
    let of_text = value.as_str().and_then(|text| text.parse().ok());
    let of_float = value.as_f64().filter(|number| number.fract() == 0.0);
    let number = value.as_i64().or(of_text).or(of_float.map(|number| number as i64));
    number.ok_or_else(|| format!("header.stamp.{name} is {value}; it must be a whole number").into())
}

/// JSON as of a stream of tracks, one or several lines of a moment. A frame is no time.
fn of_lines(bytes: &[u8]) -> Result<Option<Decoded>, LogProblem> {
    if !bytes.trim_ascii_start().starts_with(b"{") || !bytes.windows(TRACK.len()).any(|part| part == TRACK) {
        return Ok(None);
    }
    let mut reader = FrameReader::new(bytes, "the message");
    let (Some(frame), None) = (reader.next_frame()?, reader.next_frame()?) else {
        return Err("a message holds the tracks of one moment".into());
    };
    if let Some(scene) = &frame.scene {
        let advice = "record each scene on a topic of its own, without it";
        return Err(format!("the track names the scene {scene}; {advice}").into());
    }
    let seen = frame.pedestrians.iter().map(|(id, position)| SeenPedestrian {
        name: frame.names.of(*id).to_string(),
        position: Point::from(*position),
        ..SeenPedestrian::default()
    });
    let observed = Observed::new(Header::default(), seen.collect());
    Ok(Some((reader.time_unit().map(|_| frame.number), observed)))
}
