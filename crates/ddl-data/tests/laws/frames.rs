//! Tracks read frame by frame are those of the whole file.

use ddl_data::{
    Convention, DataError, Format, Frame, FrameReader, Observation, PedestrianId, Position,
    Recording, parse_recording,
};
use proptest::prelude::*;

use crate::recordings;
use crate::written::written;

fn frames(text: &[u8]) -> Result<Vec<Frame>, DataError> {
    let mut reader = FrameReader::new(text, "tracker");
    std::iter::from_fn(|| reader.next_frame().transpose()).collect()
}

/// Frames with everybody in them.
type Seen = Vec<(i64, Vec<(PedestrianId, Position)>)>;

fn of_whole(recording: &Recording) -> Seen {
    let people = |frame: &i64| {
        let at = recording.at(*frame).iter();
        (
            *frame,
            at.map(|seen| (seen.pedestrian, seen.position)).collect(),
        )
    };
    recording.frames().iter().map(people).collect()
}

fn of_frames(frames: Vec<Frame>) -> Seen {
    frames
        .into_iter()
        .map(|frame| (frame.number, frame.people))
        .collect()
}

/// What is written in a format is read back, whatever the order of its rows, and frame by frame where it can be.
fn check(recording: &Recording) {
    let mut rows = recording.observations().to_vec();
    rows.reverse();
    for format in Format::ALL {
        let text = written(&rows, format);
        let back = parse_recording(text.as_bytes(), "t", format).unwrap();
        assert_eq!(back.observations(), recording.observations(), "{format}");
        if format != Format::StarCsv {
            let text = written(recording.observations(), format);
            let whole = parse_recording(text.as_bytes(), "t", format).unwrap();
            let read = frames(text.as_bytes()).unwrap();
            assert_eq!(of_frames(read), of_whole(&whole), "{format}");
        }
    }
}

proptest! {
    #[test]
    fn frame_by_frame_as_from_the_whole(
        rows in prop::collection::btree_map((-50..50_i64, 0..6_i64), prop::array::uniform2(-1e3..1e3_f64), 1..60),
    ) {
        let rows = rows.into_iter().map(|((f, p), place)| Observation::new(f, PedestrianId(p), place));
        check(&Recording::new("t", 1, rows.collect()).unwrap());
    }
}

#[test]
fn real_recordings_too() {
    let Some(dataset) = recordings::load(Convention::Star) else {
        return;
    };
    check(&dataset.recordings()[0]);
}

#[test]
fn an_empty_line_ends_a_frame_at_once() {
    let numbers = |text: &str| -> Vec<i64> {
        let read = frames(text.as_bytes()).unwrap();
        read.iter().map(|frame| frame.number).collect()
    };
    assert_eq!(numbers("0 1 2 3\n\n\n1 1 2 3\n"), [0, 1]);
    assert_eq!(numbers("\u{feff}\n\n"), [] as [i64; 0]);
    assert_eq!(numbers(""), [] as [i64; 0]);
    let again = frames(b"0 1 2 3\n\n0 2 2 3\n").unwrap_err().to_string();
    assert!(
        again.contains("line 3: frame 0 comes after frame 0"),
        "{again}"
    );
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    let message = |text: &str| frames(text.as_bytes()).unwrap_err().to_string();
    for (text, needles) in [
        (
            "frame,pedestrian,x,y\n0,1,2,oops\n",
            ["line 2, field 4", "oops"],
        ),
        (
            "frame,pedestrian,x,y\n0,1,2\n",
            ["line 2", "3 fields where 4"],
        ),
        ("frame,pedestrian,x\n", ["line 1", "column y is missing"]),
        ("0 1 2 3\n0 1 2 4\n", ["line 2", "already (line 1)"]),
        (
            "5 1 2 3\n4 1 2 4\n",
            ["line 2", "frame 4 comes after frame 5"],
        ),
        (
            "{\"track\": {\"f\": 1}}\n",
            ["line 1", "track.p is missing"],
        ),
    ] {
        let message = message(text);
        for needle in needles {
            assert!(message.contains(needle), "{message}");
        }
    }
    let long = message(&"7".repeat(70_000));
    assert!(long.contains("longer than 65536 bytes"), "{long}");
}

/// The rest of a line that is too long is no line of its own, and those who come after it keep their numbers.
#[test]
fn a_line_without_an_end_costs_itself_alone() {
    let text = format!("{} 0 1 2 3\n0 1 2 3\nbad\n", "7".repeat(200_000));
    let mut reader = FrameReader::new(text.as_bytes(), "t");
    let wrong = |reader: &mut FrameReader<&[u8]>| reader.next_frame().unwrap_err().to_string();
    assert!(wrong(&mut reader).contains("line 1: the line is longer"));
    assert!(wrong(&mut reader).contains("line 3"));
    assert_eq!(reader.unfinished().map(|frame| frame.people.len()), Some(1));
    assert_eq!(reader.next_frame().unwrap(), None);
}

/// What is wrong costs its line, not the stream.
#[test]
fn after_an_error_the_next_line_is_read() {
    let text = b"0 1 2 3\n0 2 2 none\n0 3 2 3\n1 1 2 3\n";
    let mut reader = FrameReader::new(&text[..], "t");
    assert!(reader.next_frame().is_err());
    let people = reader.next_frame().unwrap().unwrap().people;
    assert_eq!(
        people.iter().map(|(who, _)| who.0).collect::<Vec<_>>(),
        [1, 3]
    );
    assert_eq!(reader.next_frame().unwrap().unwrap().number, 1);
    assert_eq!(reader.next_frame().unwrap(), None);
}

#[test]
fn a_frame_number_that_stands_still_does_not_fill_the_memory() {
    let mut lines: Vec<String> = (0..100_002).map(|id| format!("0 {id} 0 0")).collect();
    lines.push("1 7 0 0\n".to_owned());
    let text = lines.join("\n");
    let mut reader = FrameReader::new(text.as_bytes(), "tracker");
    for line in [100_001, 100_002] {
        let error = reader.next_frame().unwrap_err().to_string();
        let expected = format!("tracker, line {line}: more than 100000 people in frame 0");
        assert!(error.starts_with(&expected), "{error}");
    }
    let full = reader.next_frame().unwrap().unwrap();
    assert_eq!((full.number, full.people.len()), (0, 100_000));
    assert_eq!(reader.next_frame().unwrap().unwrap().number, 1);
}
