//! What is read of logs, and what is written (`reference/logs.py`).

use ddl_core::{Forecast, PedestrianId, Window};
use ddl_mcap::{ForecastLog, LogError, LoggedTracks, TrackTopic, is_log, is_mcap, read_log};
use ddl_ros::msg::{Forecasts, Header, MarkerArray, Path, People, Time};
use ddl_ros::{ForecastMessages, Message as _};
use mcap::records::MessageHeader;
use mcap::{McapResult, MessageStream, WriteOptions};
use serde_json::{Value, from_value, json};
use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::io::Cursor;
use std::slice::from_ref;
use tempfile::TempDir;

/// Logs of other programs.
const CORPUS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/fuzz/corpus/mcap");

/// Topic, type, encoding, nanoseconds of the log, and data.
type LoggedMessage = (String, String, String, u64, Value);

fn bytes((_, _, encoding, _, data): &LoggedMessage) -> Vec<u8> {
    match data {
        Value::String(text) => text.clone().into(),
        data if encoding == "cdr" => ddl_ros::write(&from_value::<People>(data.clone()).expect("people")).expect("CDR"),
        data => data.to_string().into(),
    }
}

fn log(entries: &[LoggedMessage], options: WriteOptions) -> McapResult<Vec<u8>> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = options.create(&mut file)?;
    for (entry, sequence) in entries.iter().zip(0..) {
        let (topic, kind, encoding, log_time, _) = entry;
        let schema = writer.add_schema(kind, "any", b"text")?;
        let header = MessageHeader {
            channel_id: writer.add_channel(schema, topic, encoding, &BTreeMap::new())?,
            sequence,
            log_time: *log_time,
            publish_time: log_time + 7,
        };
        writer.write_to_known_channel(&header, &bytes(entry))?;
    }
    writer.finish()?;
    drop(writer);
    Ok(file.into_inner())
}

/// Reads a file of these bytes; all but cars are pedestrians.
fn read(file: &[u8], topic: Option<&str>) -> Result<LoggedTracks, LogError> {
    let folder = TempDir::new().expect("a file");
    let path = folder.path().join("a.mcap");
    fs::write(&path, file).expect("a file");
    read_log(&path, topic, |class| class != "car")
}

/// Microsecond, name and place of each row, in the order of times and names.
fn rows(tracks: &LoggedTracks) -> Vec<(i64, String, f64, f64)> {
    let (seen, names) = (tracks.recording.observations().iter(), tracks.recording.names());
    let row = seen.map(|row| (row.frame, names.of(row.pedestrian).to_string(), row.position[0], row.position[1]));
    let mut rows: Vec<_> = row.collect();
    rows.sort_by(|a, b| (a.0, &a.1).cmp(&(b.0, &b.1)));
    rows
}

#[test]
fn messages_give_their_rows_notes_and_errors() {
    let cases: Vec<Value> = serde_json::from_str(include_str!("reference/logs.json")).unwrap();
    for mut case in cases {
        let entries: Vec<LoggedMessage> = from_value(case["messages"].take()).unwrap();
        let file = match case["file"].as_str() {
            Some(name) => fs::read(format!("{CORPUS}/{name}.mcap")).unwrap(),
            None => log(&entries, WriteOptions::new()).unwrap(),
        };
        match read(&file, case["asked"].as_str()) {
            Ok(tracks) => {
                let (log, frame) = (&tracks.recording, &tracks.topic.frame_id);
                let (restarts, step) = (log.summary().restarts, log.frame_step());
                let found = json!({
                    "rows": rows(&tracks), "notes": log.notes(), "restarts": restarts, "frame": frame, "step": step
                });
                assert_eq!(found, case["found"]);
            }
            Err(error) => assert!(error.to_string().contains(case["error"].as_str().unwrap()), "{error}"),
        }
    }
}

#[test]
fn of_a_file_that_is_cut_off_all_that_is_whole_is_read() {
    let entries = (0..4).map(|k| {
        let data = json!({"track": {"t": 100.5 + f64::from(k), "p": k, "x": 0.5, "y": 2.0}});
        from_value(json!(["/t", "", "json", 2_500_000_000_i64 * i64::from(k), data])).unwrap()
    });
    let entries: Vec<LoggedMessage> = entries.collect();
    let in_chunks = WriteOptions::new().chunk_size(Some(1));
    for options in [WriteOptions::new().use_chunks(false), in_chunks.clone()] {
        let file = log(&entries, options).unwrap();
        for end in (1..=file.len()).rev().step_by(7) {
            let part = &file[..end];
            // A message ends with its data, and with it a chunk.
            let is_whole = |entry: &&LoggedMessage| part.windows(bytes(entry).len()).any(|text| text == bytes(entry));
            let count = entries.iter().filter(is_whole).count();
            let Ok(tracks) = read(part, None) else {
                assert_eq!(count, 0);
                continue;
            };
            let times: Vec<_> = rows(&tracks).iter().map(|row| row.0).collect();
            assert_eq!(times, [100_500_000, 101_500_000, 102_500_000, 103_500_000][..count]);
            let until = format!("until {:.6} s", 2.5 * (count - 1) as f64);
            let notes = &tracks.recording.notes()[1..];
            assert!(notes.iter().all(|note| note.ends_with(&until)) && (count == 4 || notes.len() == 1));
            assert!(end < file.len() || notes.is_empty());
        }
    }
    let mut damaged = log(&entries, in_chunks).unwrap();
    let place = damaged.windows(5).position(|text| text == b"track").unwrap();
    damaged[place + 1] ^= 1;
    assert!(read(&damaged, None).unwrap_err().to_string().contains("a chunk is damaged"));
}

#[test]
fn the_files_of_a_bag_are_read_in_their_order_and_written_with_the_forecasts() {
    let cases: Vec<Value> = serde_json::from_str(include_str!("reference/logs.json")).unwrap();
    // The last kind: people in CDR, with times of their own.
    let [first, second]: [LoggedMessage; 2] = from_value(cases[6]["messages"].clone()).unwrap();
    let text: LoggedMessage = from_value(json!(["/text", "std_msgs/String", "json", 1, "{}"])).unwrap();
    let (folder, options) = (TempDir::new().unwrap(), WriteOptions::new());
    let at = |name: &str| folder.path().join(name);
    fs::write(at("z.mcap"), log(&[text, first.clone()], options.clone()).unwrap()).unwrap();
    fs::write(at("a.mcap"), log(from_ref(&second), options).unwrap()).unwrap();
    fs::write(at("old.MCAP"), "").unwrap();
    assert!(!is_log(folder.path()) && is_log(&at("x.db3")) && is_mcap(&at("x.MCAP")) && !is_mcap(&at("x.db3")));
    // An unpacked file is beside its old name.
    let list = "rosbag2_bagfile_information:\n  relative_file_paths: [z.mcap, a.mcap.zstd]\n";
    fs::write(at("metadata.yaml"), list).unwrap();
    assert!(is_log(folder.path()));
    let tracks = read_log(folder.path(), None, |_| true).unwrap();
    assert_eq!(json!(rows(&tracks)), cases[6]["found"]["rows"]);
    let (notes, restarts) = (tracks.recording.notes(), tracks.recording.summary().restarts);
    assert!(notes[1].contains("does not list are not read: 1, first ") && notes[1].ends_with("old.MCAP"));
    assert_eq!((notes.len(), restarts), (2, 0));
    for (topic, frame_id) in [(Some(&tracks.topic), "odom"), (None, "map")] {
        is_written(topic, frame_id, [&first, &second]).unwrap();
    }
}

/// A log holds the people of a topic, and the forecasts of a moment.
fn is_written(topic: Option<&TrackTopic>, frame_id: &str, people: [&LoggedMessage; 2]) -> Result<(), Box<dyn Error>> {
    let track = (0..8).map(|t| [0.5 * f64::from(t), -1.0]).collect();
    let window = &Window::new("hall", 0, 1, vec![PedestrianId(7)], vec![track])?;
    let steps = (0..24).map(|n| [3.5 + f64::from(n % 12), f64::from(n)]).collect();
    let (forecast, joint) = (&Forecast::new(1, 2, steps, vec![0.25, 0.75], None)?, true);
    let mut file = Vec::new();
    let mut writer = ForecastLog::new(&mut file, topic)?;
    assert_eq!(writer.assumed_frame(), topic.is_none().then_some("map"));
    writer.add(window, forecast, joint, 2_000_003)?;
    let early = writer.add(window, forecast, joint, -1).expect_err("early");
    assert!(early.to_string().contains("the moment -1 us is before 0"));
    writer.finish()?;
    let (stamp, frame_id) = (Time::of_microseconds(2_000_003), frame_id.to_owned());
    let header = &Header { stamp, frame_id };
    let moment = ForecastMessages { window, forecast, header, joint };
    let now = 2_000_003_000_u64;
    let made = |topic, kind, data| json!([[topic, kind, "ros2msg", "cdr"], 0, [now, now], data]);
    let mut expected = vec![
        made("/ddl/forecasts", Forecasts::TYPE, ddl_ros::write(&moment.forecasts())?),
        made("/ddl/markers", MarkerArray::TYPE, ddl_ros::write(&moment.markers())?),
        made("/ddl/paths", Path::TYPE, ddl_ros::write(&moment.likeliest_paths()[0])?),
    ];
    for (entry, number, time) in [(people[1], 0, 103_137_000_000_u64), (people[0], 1, 100_050_000_000)] {
        let copied = json!([["/seen", People::TYPE, "any", "cdr"], number, [time, entry.3 + 7], bytes(entry)]);
        expected.splice(0..0, topic.map(|_| copied));
    }
    for (message, expected) in MessageStream::new(&file)?.zip(&expected) {
        let message = message?;
        let (channel, times) = (&message.channel, [message.log_time, message.publish_time]);
        let schema = channel.schema.as_ref().ok_or("no schema")?;
        let kind = json!([channel.topic, schema.name, schema.encoding, channel.message_encoding]);
        assert_eq!(json!([kind, message.sequence, times, message.data]), *expected);
    }
    assert_eq!(MessageStream::new(&file)?.count(), expected.len());
    Ok(())
}
