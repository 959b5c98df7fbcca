//! What is read of logs, and what is written (`reference/logs.py`).

use ddl_core::{Forecast, PedestrianId, Window};
use ddl_mcap::{ForecastLog, LoggedTracks, is_log, is_mcap, read_log};
use ddl_ros::msg::{Forecasts, Header, MarkerArray, Path, People, Time};
use ddl_ros::{Message as _, Moment};
use mcap::records::MessageHeader;
use mcap::{MessageStream, WriteOptions};
use serde_json::{Value, from_value, json};
use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;
use tempfile::TempDir;

/// Logs of other programs.
const CORPUS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/fuzz/corpus/mcap");

/// Topic, type, encoding, nanoseconds of the log, and data.
type Entry = (String, String, String, u64, Value);

fn bytes((_, _, encoding, _, data): &Entry) -> Vec<u8> {
    match data {
        Value::String(text) => text.clone().into(),
        data if encoding == "cdr" => ddl_ros::write(&from_value::<People>(data.clone()).unwrap()).unwrap(),
        data => data.to_string().into(),
    }
}

fn log(entries: &[Entry], options: WriteOptions) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = options.create(&mut file).unwrap();
    for (entry, sequence) in entries.iter().zip(0..) {
        let (topic, kind, encoding, log_time, _) = entry;
        let schema = writer.add_schema(kind, "any", b"text").unwrap();
        let header = MessageHeader {
            channel_id: writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap(),
            sequence,
            log_time: *log_time,
            publish_time: log_time + 7,
        };
        writer.write_to_known_channel(&header, &bytes(entry)).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

/// Reads a file of these bytes; all but cars are pedestrians.
fn read(file: &[u8], topic: Option<&str>) -> Result<LoggedTracks, String> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    fs::write(&path, file).unwrap();
    read_log(&path, topic, |class| class != "car").map_err(|error| error.to_string())
}

/// Microsecond, name and place of each row, in the order of times and names.
fn rows(tracks: &LoggedTracks) -> Vec<(i64, String, f64, f64)> {
    let (seen, names) = (tracks.recording.observations().iter(), tracks.recording.names());
    let row = seen.map(|row| {
        (
            row.frame,
            names.of(row.pedestrian).to_string(),
            row.position[0],
            row.position[1],
        )
    });
    let mut rows: Vec<_> = row.collect();
    rows.sort_by(|a, b| (a.0, &a.1).cmp(&(b.0, &b.1)));
    rows
}

#[test]
fn messages_give_their_rows_notes_and_errors() {
    let cases: Vec<Value> = serde_json::from_str(include_str!("reference/logs.json")).unwrap();
    for mut case in cases {
        let entries: Vec<Entry> = from_value(case["messages"].take()).unwrap();
        let file = match case["file"].as_str() {
            Some(name) => fs::read(format!("{CORPUS}/{name}.mcap")).unwrap(),
            None => log(&entries, WriteOptions::new()),
        };
        match read(&file, case["asked"].as_str()) {
            Ok(tracks) => {
                let (log, frame) = (&tracks.recording, &tracks.topic.frame_id);
                let (restarts, step) = (log.summary().restarts, log.frame_step());
                let found = json!({"rows": rows(&tracks), "notes": log.notes(), "restarts": restarts, "frame": frame, "step": step});
                assert_eq!(found, case["found"]);
            }
            Err(error) => assert!(error.contains(case["error"].as_str().unwrap()), "{error}"),
        }
    }
}

#[test]
fn of_a_file_that_is_cut_off_all_that_is_whole_is_read() {
    let entries = (0..4).map(|k| {
        let data = json!({"track": {"t": 100.5 + f64::from(k), "p": k, "x": 0.5, "y": 2.0}});
        from_value(json!(["/t", "", "json", 2_500_000_000_i64 * i64::from(k), data])).unwrap()
    });
    let entries: Vec<Entry> = entries.collect();
    let in_chunks = WriteOptions::new().chunk_size(Some(1));
    for options in [WriteOptions::new().use_chunks(false), in_chunks.clone()] {
        let file = log(&entries, options);
        for end in (1..=file.len()).rev().step_by(7) {
            let part = &file[..end];
            // A message ends with its data, and with it a chunk.
            let is_whole = |entry: &&Entry| part.windows(bytes(entry).len()).any(|text| text == bytes(entry));
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
    let mut damaged = log(&entries, in_chunks);
    let place = damaged.windows(5).position(|text| text == b"track").unwrap();
    damaged[place + 1] ^= 1;
    assert!(read(&damaged, None).unwrap_err().contains("a chunk is damaged"));
}

#[test]
fn a_written_log_holds_the_tracks_of_all_files_and_the_forecasts() {
    let cases: Vec<Value> = serde_json::from_str(include_str!("reference/logs.json")).unwrap();
    // The last kind: people in CDR, with times of their own.
    let [first, second]: [Entry; 2] = from_value(cases[6]["messages"].clone()).unwrap();
    let text: Entry = from_value(json!(["/text", "std_msgs/String", "json", 1, "{}"])).unwrap();
    let (folder, options) = (TempDir::new().unwrap(), WriteOptions::new());
    let at = |name: &str| folder.path().join(name);
    fs::write(at("z.mcap"), log(&[text, first.clone()], options.clone())).unwrap();
    fs::write(at("a.mcap"), log(&[second.clone()], options)).unwrap();
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

    let track = (0..8).map(|t| [0.5 * f64::from(t), -1.0]).collect();
    let window = &Window::new("hall", 0, 1, vec![PedestrianId(7)], vec![track]).unwrap();
    let steps = (0..24).map(|n| [3.5 + f64::from(n % 12), f64::from(n)]).collect();
    let (forecast, joint) = (&Forecast::new(1, 2, steps, vec![0.25, 0.75], None).unwrap(), true);
    for (topic, frame_id) in [(Some(&tracks.topic), "odom"), (None, "map")] {
        let mut file = Vec::new();
        let mut writer = ForecastLog::new(&mut file, topic).unwrap();
        assert_eq!(writer.assumed_frame(), topic.is_none().then_some("map"));
        writer.add(window, forecast, joint, 2_000_003).unwrap();
        let early = writer.add(window, forecast, joint, -1).unwrap_err();
        assert!(early.to_string().contains("the moment -1 us is before 0"));
        writer.finish().unwrap();
        let (stamp, frame_id) = (Time::of_microseconds(2_000_003), frame_id.to_owned());
        let header = &Header { stamp, frame_id };
        let moment = Moment {
            window,
            forecast,
            header,
            joint,
        };
        let now = 2_000_003_000_u64;
        let made = |topic, kind, data: Result<_, _>| json!([topic, kind, "ros2msg", 0, now, now, data.unwrap()]);
        let mut expected = vec![
            made("/ddl/forecasts", Forecasts::TYPE, ddl_ros::write(&moment.forecasts())),
            made("/ddl/markers", MarkerArray::TYPE, ddl_ros::write(&moment.markers())),
            made("/ddl/paths", Path::TYPE, ddl_ros::write(&moment.likeliest_paths()[0])),
        ];
        for (entry, number, time) in [(&second, 0, 103_137_000_000_u64), (&first, 1, 100_050_000_000)] {
            let copied = json!(["/seen", People::TYPE, "any", number, time, entry.3 + 7, bytes(entry)]);
            expected.splice(0..0, topic.map(|_| copied));
        }
        let found = MessageStream::new(&file).unwrap().map(|message| {
            let (message, channel) = (message.as_ref().unwrap(), &message.as_ref().unwrap().channel);
            let (schema, times) = (
                channel.schema.as_ref().unwrap(),
                [message.log_time, message.publish_time],
            );
            assert_eq!(channel.message_encoding, "cdr");
            json!([
                channel.topic,
                schema.name,
                schema.encoding,
                message.sequence,
                times[0],
                times[1],
                message.data
            ])
        });
        assert_eq!(found.collect::<Vec<_>>(), expected);
    }
}
