//! Files as people have them: their columns in any order, under any of the usual names, and formats of others.

use ddl_core::PedestrianId;
use ddl_data::{ColumnChoice, DataError, Format, FrameReader, Observation, Recording, parse_columns};
use proptest::prelude::*;
use std::path::Path;

/// The name of a file, and what is chosen behind it, as in `t.csv columns=x=east keep=zone=A unit=cm homography`.
pub(crate) fn chosen(text: &str) -> (&str, ColumnChoice) {
    let (name, options) = text.split_once(' ').unwrap_or((text, ""));
    let mut options = options.split(' ');
    let given = ["columns=", "keep=", "unit="].map(|option| options.clone().find_map(|word| word.strip_prefix(option)));
    let choice = ColumnChoice::given(given, options.any(|word| word == "homography"));
    (name, choice.unwrap())
}

/// Reads a file like the program: its format is recognised.
fn read(name: &str, text: &str) -> Result<Recording, DataError> {
    let (name, choice) = chosen(name);
    let format = Format::guess(Path::new(name), text.as_bytes(), &choice)?;
    parse_columns(text.as_bytes(), name, format, &choice)
}

/// Names of frame, pedestrian, x and y, and units per metre.
const NAMES: [([&str; 4], f64); 10] = [
    (["frame", "pedestrian", "x", "y"], 1.0),
    (["frame_id", "track_id", "pos_x", "pos_y"], 1.0),
    (["Frame", "ID", "X", "Y"], 1.0),
    (["frameIndex", "agentId", "xCenter", "yCenter"], 1.0),
    (["frame_number", "ped_id", "x/m", "y/m"], 1.0),
    (["FR", "personID", "x [m]", "y [m]"], 1.0),
    (["frame no", "object id", "x(cm)", "y(cm)"], 100.0),
    (["frame", "TrackID", "x_mm", "y_mm"], 1000.0),
    (["frame", "id", "x [cm]", "y [cm]"], 100.0),
    (["frames", "person", "world_x", "world_y"], 1.0),
];
const SEPARATORS: [&str; 5] = [",", ";", "\t", ", ", " ; "];
/// Names of further columns.
const FURTHER: [&str; 4] = ["v_x", "", "note", "xVelocity"];

proptest! {
    /// Whatever the order of the columns, their names and what stands between them: the file is read as it was written.
    #[test]
    fn a_table_is_read_as_it_was_written(
        (names, per_metre) in prop::sample::select(&NAMES[..]),
        separator in prop::sample::select(&SEPARATORS[..]),
        order in Just((0..8_usize).collect::<Vec<_>>()).prop_shuffle(),
        further in 0..=4_usize,
        (trailing, comment) in any::<(bool, bool)>(),
        rows in prop::collection::btree_map((0..50_i64, 0..6_i64), prop::array::uniform2(-500..500_i32), 1..30),
    ) {
        let columns: Vec<usize> = order.into_iter().filter(|&column| column < 4 + further).collect();
        let line = |field: &dyn Fn(usize) -> String| {
            let fields: Vec<String> = columns.iter().map(|&column| field(column)).collect();
            fields.join(separator) + if trailing { separator.trim_end_matches(' ') } else { "" } + "\n"
        };
        let mut text = String::new();
        if comment {
            text += "# made by a tracker\n";
        }
        text += &line(&|column| names.get(column).unwrap_or_else(|| &FURTHER[column - 4]).to_string());
        let mut expected = Vec::new();
        for (&(frame, pedestrian), place) in &rows {
            let place = place.map(|hundredths| f64::from(hundredths) / 100.0);
            expected.push(Observation::new(frame, PedestrianId(pedestrian), place));
            text += &line(&|column| match column {
                0 => frame.to_string(),
                1 => pedestrian.to_string(),
                2 | 3 => format!("{:.2}", place[column - 2] * per_metre),
                _ => "7.5".to_owned(),
            });
        }
        let recording = read("t.csv", &text).unwrap();
        for (found, expected) in recording.observations().iter().zip(&expected) {
            prop_assert_eq!((found.frame, found.pedestrian), (expected.frame, expected.pedestrian));
            prop_assert!((0..2).all(|axis| (found.position[axis] - expected.position[axis]).abs() < 1e-9));
        }
        prop_assert_eq!(recording.observations().len(), expected.len());
        // A stream reads the same.
        let mut frames = FrameReader::new(text.as_bytes(), "t");
        let streamed = std::iter::from_fn(|| frames.next_frame().unwrap()).map(|frame| frame.pedestrians.len());
        prop_assert_eq!(streamed.sum::<usize>(), expected.len());
    }

    /// Of two columns of whole numbers the one along which pedestrians walk is the time; the other way round the file
    /// is refused or read alike.
    #[test]
    fn four_columns_are_read_as_they_were_written_or_refused(
        step in prop::sample::select(vec![1_i64, 6, 10]),
        people in prop::collection::vec((prop::array::uniform2(-10.0..10.0_f64), 0.5..1.8_f64, 0..8_i64), 1..12),
        (frame_first, by_frame) in any::<(bool, bool)>(),
    ) {
        let mut rows = Vec::new();
        for (id, &([x, y], speed, first)) in (1..).zip(&people) {
            rows.extend((first..first + 12).map(|t| (t * step, id, x + 0.4 * speed * t as f64, y)));
        }
        rows.sort_by_key(|&(frame, id, ..)| if by_frame { (frame, id) } else { (id, frame) });
        let lines = rows.iter().map(|(frame, id, x, y)| {
            let [first, second] = if frame_first { [frame, id] } else { [id, frame] };
            format!("{first} {second} {x:.3} {y:.3}\n")
        });
        match read("t.txt", &lines.collect::<String>()) {
            Ok(recording) => {
                rows.sort_by_key(|&(frame, id, ..)| (frame, id));
                let found = recording.observations().iter().map(|seen| (seen.frame, seen.pedestrian.0));
                prop_assert!(found.eq(rows.iter().map(|&(frame, id, ..)| (frame, id))), "{people:?}");
            }
            Err(error) => prop_assert!(error.to_string().contains("write the line frame,pedestrian,x,y"), "{error}"),
        }
    }
}

/// Files that are not in order of time.
#[test]
fn splines_and_lists_of_tracks_are_read() {
    let edinburgh =
        "Properties.R1=[ 3 1 ];\nTRACK.R1=[[100 200 5];[110 200 6];[110 200 6]];\nTRACK.R2=[[ 10 20 7 ]];\n";
    let rows = |name: &str, text: &str| -> (Recording, Vec<_>) {
        let recording = read(name, text).unwrap();
        let row = |seen: &Observation| (seen.pedestrian.0, seen.frame, seen.position);
        let rows = recording.observations().iter().map(row).collect();
        (recording, rows)
    };
    let (recording, metres) = rows("tracks.01Jul.txt", edinburgh);
    let (_, pixels) = rows("tracks.01Jul.txt homography", edinburgh);
    assert_eq!(pixels, [(1, 5, [100.0, 200.0]), (1, 6, [110.0, 200.0]), (2, 7, [10.0, 20.0])]);
    for (metres, pixels) in metres.iter().zip(pixels) {
        assert!((0..2).all(|axis| (metres.2[axis] - 0.0247 * pixels.2[axis]).abs() < 1e-12));
    }
    assert_eq!((metres.len(), recording.stated_frame_time()), (3, Some(1.0 / 9.0)));
    let notes = recording.notes().join("; ");
    assert!(notes.contains("24.7 mm") && notes.contains("1 at the same frame"), "{notes}");

    // A spline that begins at a frame that counts, and one with parts of 500 and of 501 frames.
    let vsp = "3 - the number of splines\n3 - Num of control points\n-10.0 40.0 5 0.5 - (2D point, m_id)\n\
               10 40 25 0\n10 60 45 0\n3 - Num of control points\n7 1 -20 0\n3 9 -10 0\n3 3 -5 0\n\
               4 - Num of control points\n0 0 1007 0\n50 100 1507 0\n8 8 2008 0\n6 9 2010 0\n";
    let (recording, mut rows) = rows("annotation.vsp", vsp);
    assert_eq!(recording.stated_frame_time(), Some(1.0 / 25.0));
    assert!(recording.notes()[0].contains("a forecast knows where the next one lies"));
    assert!(recording.notes().iter().any(|note| note.contains("left out: 1 splines")));
    let long = rows.split_off(6);
    let first = [(1, 10, [-5.0, 40.0]), (1, 20, [5.0, 40.0]), (1, 30, [10.0, 45.0]), (1, 40, [10.0, 55.0])];
    assert_eq!(rows, [&[(2, -20, [7.0, 1.0]), (2, -10, [3.0, 9.0])], &first[..]].concat());
    for (k, (who, frame, [x, y])) in (0..50).zip(&long) {
        assert_eq!((*who, *frame), (3, 1010 + 10 * k));
        let way = (10 * k + 3) as f64 / 500.0;
        assert!((x - 50.0 * way).abs() < 1e-9 && (y - 100.0 * way).abs() < 1e-9);
    }
    assert_eq!((long.len(), long[50]), (51, (3, 2010, [6.0, 9.0])));
}

#[test]
fn formats_of_others_are_read_and_what_was_assumed_is_told() {
    let (_, samples) = include_str!("samples.txt").split_once("\n\n").unwrap();
    let lines: Vec<&str> = samples.lines().collect();
    for [file, expected] in lines.as_chunks().0 {
        let (name, text) = file.split_once(": ").unwrap();
        let text = text.replace("\\n", "\n").replace("\\t", "\t") + "\n";
        let mut expected = expected.trim_start_matches("=> ").splitn(7, ' ');
        let (path, choice) = chosen(name);
        let format = Format::guess(Path::new(path), text.as_bytes(), &choice).unwrap();
        assert_eq!(Some(format.name()), expected.next(), "{file}");
        let mut number = || expected.next().unwrap().parse::<f64>().unwrap();
        let (frame, pedestrian, place) = (number() as i64, PedestrianId(number() as i64), [number(), number()]);
        let count = number() as usize;
        let recording = read(name, &text).unwrap();
        assert_eq!(recording.observations()[0], Observation::new(frame, pedestrian, place), "{file}");
        assert_eq!(recording.observations().len(), count, "{file}");
        let notes = recording.notes().join("; ");
        let mut expected = expected.next().unwrap().split('|');
        let is_told = |note: &str| note.strip_prefix('!').map_or(notes.contains(note), |no| !notes.contains(no));
        assert!(expected.all(is_told), "{file}: {notes}");
        // A stream reads the same.
        let mut frames = FrameReader::new(text.as_bytes(), "t").with_columns(choice);
        let streamed = std::iter::from_fn(|| frames.next_frame().unwrap());
        let streamed: Vec<_> = streamed.flat_map(|frame| frame.pedestrians).collect();
        assert_eq!((streamed.len(), streamed[0]), (count, (pedestrian, place)), "{file}");
    }
    let rate = read("a.txt", "# framerate: 25 fps\n# id frame x y\n1 0 1 3\n1 2 2 3\n").unwrap();
    assert_eq!(rate.stated_frame_time(), Some(1.0 / 25.0));
}

#[test]
fn every_format_is_recognised() {
    for case in include_str!("recognised.txt").lines().skip(2) {
        let (file, format) = case.split_once(" => ").unwrap();
        let (name, text) = file.split_once("::").unwrap();
        let text = text.replace("\\n", "\n").replace("\\t", "\t");
        let guessed = Format::guess(name.as_ref(), text.as_bytes(), &ColumnChoice::default()).unwrap();
        assert_eq!(guessed.name(), format, "{case}");
    }
}

/// A header of many names has a short message, and many such lines have one in a short time.
#[test]
fn messages_are_short() {
    let (begin, lines) = (std::time::Instant::now(), ("a,".repeat(50_000) + "\n").repeat(60));
    for text in [&(",".repeat(200_000) + "\n"), &lines] {
        let message = read("wide.csv", text).unwrap_err().to_string();
        assert!(message.len() < 400, "{message}");
    }
    assert!(begin.elapsed().as_secs() < 20, "{:?}", begin.elapsed());
}

/// A stream tells what it assumes at its first frame, and that it leaves rows out when it first does.
#[test]
fn a_stream_tells_each_thing_once() {
    let text = "time,id,label,x_cm,y_cm\n0,1,ped,0,0\n.4,1,ped,9,0\n.4,2,car,9,0\n1,1,ped,18,0\n1,2,car,9,0\n";
    let mut frames = FrameReader::new(text.as_bytes(), "t");
    let mut told = Vec::new();
    while let Some(frame) = frames.next_frame().unwrap() {
        assert_eq!(frame.pedestrians.len(), 1);
        told.push(frames.take_notes().join("; "));
    }
    assert_eq!(told[..2], ["the positions are in centimetres", "rows are left out: of class car"]);
    assert!(told[2].is_empty());
}

#[test]
fn columns_are_chosen_where_there_are_any() {
    let given = "time_ms=stamp,pedestrian=who";
    assert_eq!(ColumnChoice::default().with_columns(given).unwrap().to_string(), given);
    let stream = FrameReader::new(&br#"{"track":{"f":0,"p":1,"x":2,"y":3}}"#[..], "t");
    let refused = stream.with_columns(chosen("t unit=cm").1).next_frame().unwrap_err();
    assert!(refused.to_string().contains("leave out columns"), "{refused}");
}
