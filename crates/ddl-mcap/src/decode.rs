//! From a message to the pedestrians in it.

use crate::messages::{Channel, Message};
use ddl_data::FrameReader;
use ddl_ros::msg::{Detection3DArray, Header, People, Point, Time, TrackedPersons};
use ddl_ros::{Message as _, Observed, RosError, SeenPedestrian, read_tracks};
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

/// The pedestrians of a message.
pub(crate) struct Decoded {
    pub(crate) microseconds: i64,
    /// Whether this is the time of the log, because the message has none.
    pub(crate) is_logged: bool,
    pub(crate) observed: Observed,
}

/// The type of a channel as ROS 2 writes it.
pub(crate) fn type_name(channel: &Channel) -> String {
    let name = channel.schema.as_ref().map_or("", |schema| &schema.name);
    match name.split_once('/') {
        Some((package, message)) if !message.contains('/') => format!("{package}/msg/{message}"),
        _ => name.to_owned(),
    }
}

/// Whether a channel may hold tracks. JSON of other types is looked at.
pub(crate) fn may_hold_tracks(channel: &Channel) -> bool {
    channel.encoding == "json" || (channel.encoding == "cdr" && of_type(channel).is_some())
}

fn of_type(channel: &Channel) -> Option<&'static [&'static str; 4]> {
    let name = type_name(channel);
    TYPES.iter().find(|[known, ..]| *known == name)
}

/// The pedestrians; `None` if the message is of another kind.
pub(crate) fn decode(message: &Message) -> Result<Option<Decoded>, String> {
    let bytes = &*message.data;
    let observed = match (&*message.channel.encoding, of_type(&message.channel)) {
        ("cdr", Some([name, ..])) => match read_tracks(name, bytes) {
            // A time stands in for the one that is missing: the first field.
            Err(RosError::NoTime { .. }) => {
                let stamped = [&bytes[..4], &[1], &bytes[5..]].concat();
                read_tracks(name, &stamped).map(|observed| (None, observed))
            }
            read => read.map(|observed| (Some(observed.header.stamp.microseconds()), observed)),
        }
        .map_err(|error| error.to_string())?,
        ("json", Some(layout)) => of_json(bytes, layout)?,
        ("json", None) => match of_lines(bytes)? {
            Some(read) => read,
            None => return Ok(None),
        },
        _ => return Ok(None),
    };
    let (stamp, observed) = observed;
    Ok(Some(Decoded {
        microseconds: stamp.unwrap_or((message.log_time / 1000) as i64),
        is_logged: stamp.is_none(),
        observed,
    }))
}

/// A time, where there is one, and the pedestrians.
type Read = (Option<i64>, Observed);

/// A ROS message as JSON; of its fields those that are needed.
fn of_json(bytes: &[u8], [_, list, name, position]: &[&str; 4]) -> Result<Read, String> {
    let message: Value = serde_json::from_slice(bytes).map_err(|error| format!("it is not JSON: {error}"))?;
    let items = message[*list]
        .as_array()
        .ok_or_else(|| format!("it has no list `{list}`"))?;
    let (mut pedestrians, mut occluded) = (Vec::new(), 0);
    for (index, item) in items.iter().enumerate() {
        if item["is_occluded"] == true {
            occluded += 1;
            continue;
        }
        let wrong = |field: &str, wanted: &str| format!("{list}[{index}]{}: {wanted}", field.replace('/', "."));
        let coordinate = |axis: &str| {
            let number = item.pointer(position).and_then(|point| point[axis].as_f64());
            number.ok_or_else(|| wrong(position, &format!("{axis} must be a number of metres")))
        };
        pedestrians.push(SeenPedestrian {
            name: match item.pointer(name) {
                Some(Value::String(word)) if !word.is_empty() => word.clone(),
                Some(Value::Number(number)) => number.to_string(),
                _ => return Err(wrong(name, "each pedestrian needs a name")),
            },
            class: likeliest_class(item),
            position: Point {
                x: coordinate("x")?,
                y: coordinate("y")?,
                z: 0.0,
            },
        });
    }
    let header = &message["header"];
    // ROS 2, Foxglove, ROS 1.
    let part = |names: [&str; 3]| {
        names
            .iter()
            .find_map(|name| header["stamp"][name].as_i64())
            .unwrap_or(0)
    };
    let (sec, nanosec) = (part(["sec", "secs", "sec"]), part(["nanosec", "nsec", "nsecs"]));
    let microseconds = sec.saturating_mul(1_000_000).saturating_add(nanosec / 1000);
    let frame_id = header["frame_id"].as_str().unwrap_or_default().to_owned();
    let stamp = Time::of_microseconds(microseconds);
    let observed = Observed {
        header: Header { stamp, frame_id },
        pedestrians,
        occluded,
    };
    Ok(((microseconds != 0).then_some(microseconds), observed))
}

fn likeliest_class(detection: &Value) -> String {
    let results = detection["results"].as_array().into_iter().flatten();
    let hypotheses = results.map(|result| &result["hypothesis"]);
    let score = |hypothesis: &Value| hypothesis["score"].as_f64().unwrap_or(0.0);
    let likeliest = hypotheses.max_by(|a, b| score(a).total_cmp(&score(b)));
    let class = likeliest.and_then(|hypothesis| hypothesis["class_id"].as_str());
    class.unwrap_or_default().to_owned()
}

/// JSON as `ddl forecast -` reads it, one or several lines of a moment. A frame is no time.
fn of_lines(bytes: &[u8]) -> Result<Option<Read>, String> {
    let has_track = bytes.windows(TRACK.len()).any(|window| window == TRACK);
    if !(has_track && bytes.trim_ascii_start().starts_with(b"{")) {
        return Ok(None);
    }
    let mut reader = FrameReader::new(bytes, "the message");
    let mut next = || reader.next_frame().map_err(|error| error.to_string());
    let (Some(frame), None) = (next()?, next()?) else {
        return Err("a message holds the tracks of one moment".to_owned());
    };
    let seen = frame.pedestrians.iter().map(|(id, [x, y])| SeenPedestrian {
        name: frame.names.of(*id).to_string(),
        class: String::new(),
        position: [*x, *y].into(),
    });
    let observed = Observed {
        header: Header::default(),
        pedestrians: seen.collect(),
        occluded: 0,
    };
    Ok(Some((reader.time_unit().map(|_| frame.number), observed)))
}
