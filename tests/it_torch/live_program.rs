//! `ddl forecast -`: a tracker writes, the program answers frame by frame.

use ddl::Variant;
use ddl_tests::own_tracks::{self, Row};
use ddl_tests::{program, tiny_model};
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

/// The program at work.
struct Live {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Live {
    fn start(folder: &Path, options: &str) -> Self {
        let line = format!("forecast - --model . --threads 1 --format jsonl {options}");
        let mut child = program::command(folder, &line)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let output = BufReader::new(child.stdout.take().unwrap());
        Self {
            input: child.stdin.take(),
            output,
            child,
        }
    }

    fn write(&mut self, text: &str) {
        let input = self.input.as_mut().unwrap();
        input.write_all(text.as_bytes()).unwrap();
        input.flush().unwrap();
    }

    fn line(&mut self) -> Value {
        let mut line = String::new();
        self.output.read_line(&mut line).unwrap();
        serde_json::from_str(&line).unwrap()
    }

    /// The rest of the output, what was told, and the exit code.
    fn end(mut self) -> (String, String, Option<i32>) {
        drop(self.input.take());
        let mut rest = String::new();
        std::io::Read::read_to_string(&mut self.output, &mut rest).unwrap();
        let finished = self.child.wait_with_output().unwrap();
        let told = String::from_utf8(finished.stderr).unwrap();
        (rest, told, finished.status.code())
    }
}

fn rows_of(rows: &[Row], frame: i64) -> String {
    let here: Vec<Row> = rows.iter().copied().filter(|row| row.0 == frame).collect();
    let table = own_tracks::csv(&here);
    let (_, rows) = table.split_once('\n').unwrap();
    rows.to_owned()
}

/// The same but for rounding: the network computes many windows at once, or one.
fn assert_alike(a: &Value, b: &Value) {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            let [a, b] = [a, b].map(|number| number.as_f64().unwrap());
            assert!((a - b).abs() < 1e-4, "{a} and {b}");
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len());
            a.iter().zip(b).for_each(|(a, b)| assert_alike(a, b));
        }
        (Value::Object(a), Value::Object(b)) => {
            assert!(a.keys().eq(b.keys()));
            a.values()
                .zip(b.values())
                .for_each(|(a, b)| assert_alike(a, b));
        }
        _ => assert_eq!(a, b),
    }
}

/// The answer comes while the tracker still waits with the next frame, and is that of the file.
#[test]
fn every_frame_is_answered_before_the_next_one_comes() {
    let folder = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(10);
    let expected = program::forecast(folder.path(), &rows, "--format jsonl").succeeds();
    let mut expected = expected
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap());
    let mut live = Live::start(folder.path(), "--whole --fps 25");
    live.write("frame,pedestrian,x,y\n");
    for frame in (0..100).step_by(10) {
        // an empty line ends the frame
        live.write(&(rows_of(&rows, frame) + "\n"));
        if frame >= 70 {
            for _ in 0..3 {
                assert_alike(&live.line(), &expected.next().unwrap());
            }
        }
    }
    let (rest, told, code) = live.end();
    assert_eq!((rest.as_str(), told.as_str(), code), ("", "", Some(0)));
    assert_eq!(expected.next(), None);
}

/// From the second frame on, the step learned from the first two.
#[test]
fn two_frames_are_enough() {
    let folder = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(10);
    let mut live = Live::start(folder.path(), "--one --certificate");
    live.write("frame,pedestrian,x,y\n");
    live.write(&(rows_of(&rows, 0) + &rows_of(&rows, 10) + "\n"));
    let first = live.line();
    assert_eq!(
        (&first["observed_until"], &first["padded"]),
        (&Value::from(10), &Value::from(6))
    );
    assert_eq!(first["hypotheses"].as_array().unwrap().len(), 1);
    assert_eq!(first["hypotheses"][0]["certificate"]["holds"], true);
    let (rest, told, code) = live.end();
    assert_eq!((rest.lines().count(), code), (2, Some(0)));
    assert!(told.contains("10 apart in 0.4 s"), "{told}");
}

/// What came before a bad line has been answered.
#[test]
fn a_bad_line_is_named_and_nothing_before_it_is_lost() {
    let folder = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(9);
    let bad: [(&str, &str); 3] = [
        ("90,1,left,2\n", "line 29, field 3"),
        ("0,1,1,2\n", "line 29: frame 0 comes after frame 80"),
        ("80,1,1,2\n", "line 29: pedestrian 1 is in frame 80 already"),
    ];
    for (bad, message) in bad {
        let mut live = Live::start(folder.path(), "--whole --frame-step 10");
        live.write("frame,pedestrian,x,y\n");
        for frame in (0..90).step_by(10) {
            live.write(&rows_of(&rows, frame));
        }
        live.write(bad);
        let (rest, told, code) = live.end();
        // frame 80, which the bad line ends, is answered too
        assert_eq!((rest.lines().count(), code), (6, Some(1)), "{told}");
        assert!(
            told.starts_with("error: standard input, ") && told.contains(message),
            "{told}"
        );
    }
}

#[test]
fn what_cannot_be_live_is_refused() {
    let folder = tiny_model::folder(Variant::Full);
    let fails = |line: &str| program::run(folder.path(), line).fails();
    assert!(fails("forecast - --model . --last").contains("--last"));
    assert!(fails("forecast - --model . --fps 24").contains("9.6 frames"));
    assert!(fails("goals - --model .").contains("ddl forecast -"));
    // standard input is empty
    assert!(fails("forecast - --model .").contains("holds no tracks"));
}

/// Pixels are seen in the speeds as soon as somebody was seen whole, and told once.
#[test]
fn speeds_that_nobody_walks_at_are_told_once() {
    let folder = tiny_model::folder(Variant::Full);
    let mut rows = own_tracks::three_people(12);
    for row in &mut rows {
        row.2 *= 100.0;
    }
    let mut live = Live::start(folder.path(), "--frame-step 10 --one");
    live.write(&own_tracks::csv(&rows));
    let (_, told, code) = live.end();
    assert_eq!(code, Some(0), "{told}");
    assert_eq!(told.matches("warning: half of the steps").count(), 1);
}

/// Somebody who moves as nobody in the training did comes late in the stream, and is told of once.
#[test]
fn an_unfamiliar_motion_is_told_of_once_whenever_it_comes() {
    let place = tempfile::tempdir().unwrap();
    let mut rows = own_tracks::three_people(20);
    // From side to side, 8 m a step.
    rows.extend((8..20).map(|t| (10 * t, 4, t as f64, 8.0 * (t % 2) as f64)));
    rows.sort_by_key(|row| (row.0, row.1));
    let line = "forecast - --threads 1 --whole --frame-step 10";
    for options in ["", " --certificate --one"] {
        let mut child = program::command(place.path(), &format!("{line}{options}"))
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut input = child.stdin.take().unwrap();
        input.write_all(own_tracks::csv(&rows).as_bytes()).unwrap();
        drop(input);
        let told = String::from_utf8(child.wait_with_output().unwrap().stderr).unwrap();
        let unlike = "motions are unlike those that the model was trained on";
        assert_eq!(told.matches(unlike).count(), 1, "{told}");
        assert!(
            told.contains("that of pedestrian 4 observed until frame 150"),
            "{told}"
        );
    }
}

/// An input without a forecast replaces nothing.
#[test]
fn a_file_from_before_stays_until_there_is_a_forecast() {
    let folder = tiny_model::folder(Variant::Full);
    let file = folder.path().join("out.csv");
    std::fs::write(&file, "from before").unwrap();
    let line = "forecast - --model . --output out.csv";
    let message = program::run(folder.path(), line).fails();
    assert!(message.contains("holds no tracks"), "{message}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "from before");
}

/// Who has seen enough may go.
#[test]
fn a_reader_that_leaves_ends_it_quietly() {
    let folder = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(10);
    let mut live = Live::start(folder.path(), "--fps 25");
    live.write("frame,pedestrian,x,y\n");
    live.write(&(rows_of(&rows, 0) + &rows_of(&rows, 10) + "\n"));
    live.line();
    let Live {
        child,
        input,
        output,
    } = live;
    drop(output);
    let mut input = input.unwrap();
    for frame in (20..100).step_by(10) {
        // it may have gone already
        let _ = input.write_all((rows_of(&rows, frame) + "\n").as_bytes());
    }
    drop(input);
    let finished = child.wait_with_output().unwrap();
    let told = String::from_utf8(finished.stderr).unwrap();
    assert_eq!((told.as_str(), finished.status.code()), ("", Some(0)));
}

/// In a file too: straight on, at constant speed, one hypothesis a pedestrian.
#[test]
fn one_forecast_of_a_file() {
    let folder = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(8);
    let text = program::forecast(folder.path(), &rows, "--one --format jsonl").succeeds();
    assert_eq!(text.lines().count(), 3);
    for line in text.lines() {
        let line: Value = serde_json::from_str(line).unwrap();
        let hypotheses = line["hypotheses"].as_array().unwrap();
        assert_eq!(hypotheses.len(), 1);
        let number = |value: &Value| value.as_f64().unwrap();
        assert!((number(&hypotheses[0]["weight"]) - 1.0).abs() < 1e-15);
        let path = hypotheses[0]["positions"].as_array().unwrap();
        let goal = hypotheses[0]["goal"].as_array().unwrap();
        let left = |t: usize| {
            let off = |axis: usize| number(&path[t][axis]) - number(&goal[axis]);
            off(0).hypot(off(1))
        };
        assert!((1..12).all(|t| left(t) < left(t - 1)) && left(11) < 1e-6);
    }
}
