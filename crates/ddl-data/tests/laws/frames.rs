//! Tracks read frame by frame equal those of the whole file.

use std::collections::{BTreeMap, VecDeque};
use std::fmt::Write as _;
use std::time::Duration;

use ddl_core::{PedestrianId, Position};
use ddl_data::{
    Convention, DataError, Format, Frame, FrameReader, Observation, Recording, SceneName, parse_recording,
    write_recording,
};
use proptest::prelude::*;

use crate::recordings;

fn frames(text: &[u8]) -> Result<Vec<Frame>, DataError> {
    let mut reader = FrameReader::new(text, "tracker");
    std::iter::from_fn(|| reader.next_frame().transpose()).collect()
}

type Seen = Vec<(i64, Vec<(PedestrianId, Position)>)>;

fn of_whole(recording: &Recording) -> Seen {
    let pedestrians = |frame: &i64| {
        let rows = recording.at(*frame).iter();
        (*frame, rows.map(|seen| (seen.pedestrian, seen.position)).collect())
    };
    recording.frames().iter().map(pedestrians).collect()
}

fn of_frames(frames: Vec<Frame>) -> Seen {
    frames.into_iter().map(|frame| (frame.number, frame.pedestrians)).collect()
}

/// Checks that a written recording is read back, with its rows in any order. Formats that can be read frame by frame
/// are also read in that way.
fn check(recording: &Recording) {
    for format in Format::WRITTEN {
        let text = String::from_utf8(write_recording(recording, format).unwrap()).unwrap();
        let back = parse_recording(text.as_bytes(), "t", format).unwrap();
        assert_eq!(back.observations(), recording.observations(), "{format}");
        if format == Format::StarCsv {
            continue;
        }
        assert_eq!(of_frames(frames(text.as_bytes()).unwrap()), of_whole(&back), "{format}");
        let mut lines: Vec<&str> = text.lines().collect();
        let first_row = usize::from(format == Format::Table);
        lines[first_row..].reverse();
        let back = parse_recording(lines.join("\n").as_bytes(), "t", format).unwrap();
        assert_eq!(back.observations(), recording.observations(), "{format}");
    }
}

proptest! {
    #[test]
    fn reading_frame_by_frame_equals_reading_the_file(
        rows in prop::collection::btree_map((-50..50_i64, 0..6_i64), prop::array::uniform2(-1e3..1e3_f64), 1..60),
    ) {
        let rows = rows.into_iter().map(|((f, p), place)| Observation::new(f, PedestrianId(p), place));
        check(&Recording::new("t", 1, rows.collect()).unwrap());
    }
}

#[test]
fn real_recordings_are_read_back() {
    let Some(dataset) = recordings::load(Convention::Star) else { return };
    check(&dataset.recordings()[0]);
}

#[test]
fn an_empty_line_ends_a_frame_at_once() {
    let numbers =
        |text: &str| -> Vec<i64> { frames(text.as_bytes()).unwrap().iter().map(|frame| frame.number).collect() };
    assert_eq!(numbers("0 1 2 3\n\n\n1 1 2 3\n"), [0, 1]);
    assert_eq!(numbers("\u{feff}\n\n"), [] as [i64; 0]);
    assert_eq!(numbers(""), [] as [i64; 0]);
    let again = frames(b"0 1 2 3\n\n0 2 2 3\n").unwrap_err().to_string();
    assert!(again.contains("line 3: frame 0 comes after frame 0"), "{again}");
}

#[test]
fn after_an_error_the_next_line_is_read() {
    let text = format!("{} 0 1 2 3\n0 1 2 3\n0 2 2 none\n0 3 2 3\n1 1 2 3\nbad\n", "7".repeat(200_000));
    let mut reader = FrameReader::new(text.as_bytes(), "t");
    let wrong = |reader: &mut FrameReader<&[u8]>| reader.next_frame().unwrap_err().to_string();
    assert!(wrong(&mut reader).contains("line 1: the line is longer than 65536 bytes"));
    assert!(wrong(&mut reader).contains("line 3"));
    let pedestrians: Vec<i64> = reader.next_frame().unwrap().unwrap().pedestrians.iter().map(|(id, _)| id.0).collect();
    assert_eq!(pedestrians, [1, 3]);
    assert!(wrong(&mut reader).contains("line 6"));
    assert_eq!(reader.unfinished().map(|frame| frame.number), Some(1));
    assert_eq!(reader.next_frame().unwrap(), None);
}

#[test]
fn a_constant_frame_number_does_not_fill_the_memory() {
    let mut lines: Vec<String> = (0..100_002).map(|id| format!("0 {id} 0 0")).collect();
    lines.push("1 7 0 0\n".to_owned());
    let text = lines.join("\n");
    let mut reader = FrameReader::new(text.as_bytes(), "tracker");
    for line in [100_001, 100_002] {
        let error = reader.next_frame().unwrap_err().to_string();
        let expected = format!("tracker, line {line}: more than 100000 pedestrians in frame 0");
        assert!(error.starts_with(&expected), "{error}");
    }
    let full = reader.next_frame().unwrap().unwrap();
    assert_eq!((full.number, full.pedestrians.len()), (0, 100_000));
    assert_eq!(reader.next_frame().unwrap().unwrap().number, 1);
}

fn by_scene(frames: Vec<Frame>) -> BTreeMap<Option<SceneName>, Vec<Frame>> {
    let mut scenes = BTreeMap::<_, Vec<_>>::new();
    for frame in frames {
        scenes.entry(frame.scene.clone()).or_default().push(frame);
    }
    scenes
}

proptest! {
    #[test]
    fn interleaved_scenes_are_read_as_each_alone(
        rows in prop::collection::btree_set((0..3_usize, 0..20_i64, 0..4_usize), 1..60),
        turns in prop::collection::vec(0..3_usize, 60),
        as_json: bool,
    ) {
        let names = ["hall", "Tür 2", "7"];
        let who = ["1", "017", "7f3e", "4"];
        let line = |&(scene, frame, id): &(usize, i64, usize)| {
            let (scene, who, x) = (names[scene], who[id], 0.5 * frame as f64);
            if as_json {
                format!("{{\"track\":{{\"scene\":\"{scene}\",\"f\":{frame},\"p\":\"{who}\",\"x\":{x},\"y\":0}}}}\n")
            } else {
                format!("{x},0, {scene} ,{frame},{who}\n")
            }
        };
        let head = if as_json { "" } else { "x,y,Scene,frame,pedestrian\n" };
        let mut queues: Vec<VecDeque<_>> = (0..3)
            .map(|scene| rows.iter().filter(|row| row.0 == scene).collect())
            .collect();
        let mut mixed = head.to_owned();
        for scene in turns.into_iter().chain((0..3).cycle().take(180)) {
            mixed.extend(queues[scene].pop_front().map(line));
        }
        let mixed = by_scene(frames(mixed.as_bytes()).unwrap());
        for (scene, name) in names.into_iter().enumerate() {
            let lines = rows.iter().filter(|row| row.0 == scene).map(line);
            let alone = frames((head.to_owned() + &lines.collect::<String>()).as_bytes()).unwrap();
            let seen = |frames: &[Frame]| -> Vec<_> {
                let people = |frame: &Frame| -> Vec<_> {
                    frame.pedestrians.iter().map(|&(id, place)| (frame.names.of(id), place)).collect()
                };
                frames.iter().map(|frame| (frame.number, frame.is_first, people(frame))).collect()
            };
            let name = Some(SceneName::new(name).unwrap());
            let mixed = mixed.get(&name).cloned().unwrap_or_default();
            prop_assert_eq!(seen(&mixed), seen(&alone));
        }
    }
}

#[test]
fn an_empty_line_ends_the_frame_of_the_scene_before_it() {
    let text = "scene,frame,pedestrian,x,y\na,0,1,2,3\nb,0,1,2,3\n\na,0,2,2,3\n";
    let read = frames(text.as_bytes()).unwrap();
    let read = read.iter().map(|frame| (frame.scene.as_ref().unwrap().as_str(), frame.pedestrians.len()));
    assert_eq!(read.collect::<Vec<_>>(), [("b", 1), ("a", 2)]);
}

#[test]
fn scenes_that_fall_silent_make_room() {
    let mut text = "scene,frame,pedestrian,x,y\n".to_owned();
    for scene in 0..1_001 {
        writeln!(text, "{scene},5,1,2,3").unwrap();
    }
    text += "7,0,1,2,3\n";
    let mut reader = FrameReader::new(text.as_bytes(), "tracker");
    let error = reader.next_frame().unwrap_err().to_string();
    assert!(
        error.starts_with("tracker, line 1002: scene 1000 exceeds the limit of 1000 scenes")
            && error.contains("10 minutes"),
        "{error}"
    );
    let early = reader.next_frame().unwrap_err().to_string();
    assert!(early.contains("frame 0 of scene 7 comes after frame 5"), "{early}");
    assert_eq!(std::iter::from_fn(|| reader.unfinished()).count(), 1_000);
    // With an idle timeout of zero, every frame is the first of its scene.
    let mut reader = FrameReader::new(text.as_bytes(), "tracker").forgetting_after(Duration::ZERO);
    let read: Vec<Frame> = std::iter::from_fn(|| reader.next_frame().unwrap()).collect();
    assert_eq!(read.len(), 1_002);
    assert!(read.iter().all(|frame| frame.is_first));
}
