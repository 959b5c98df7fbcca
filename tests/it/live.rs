//! Forecasts frame by frame, and those of `ddl forecast -`, which reads from a tracker, agree with forecasts of the
//! windows of the whole recording.

use ddl::data::LiveTracks;
use ddl::{DdlError, Request, Session, Variant};
use ddl_tests::drawn_model;
use ddl_tests::own_tracks::{self, FRAME_STEP, Row};
use ddl_tests::place::{Place, json, json_lines};
use ddl_tests::program;
use ddl_tests::program::Finished;
use serde_json::Value;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

#[test]
fn an_error_changes_nothing() {
    let rows = own_tracks::three_pedestrians(9);
    let frames = own_tracks::frames(&rows);
    let pedestrians = |frame: i64| frames[&frame].clone();
    let (model, tracks) = (drawn_model::of(Variant::Full), LiveTracks::with_frame_step(FRAME_STEP).unwrap());
    let mut session = Session::new(&model, tracks, Request::one()).unwrap();
    session.push(0, pedestrians(0)).unwrap();
    for frame in (10..90).step_by(10) {
        let before = session.tracks(None).cloned();
        let error = session.push(frame - 10, pedestrians(frame)).unwrap_err();
        assert!(matches!(error, DdlError::Live(_)), "{error}");
        assert_eq!(session.tracks(None).cloned(), before);
        let now = session.push(frame, pedestrians(frame)).unwrap();
        assert_eq!(now.answer.is_some(), frame >= 70);
    }
}

/// A program that forecasts a stream of standard input.
pub(crate) struct LiveProgram {
    pub(crate) child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl LiveProgram {
    pub(crate) fn start(place: &Place, options: &str) -> Self {
        Self::of(place, &format!("forecast - --model run --threads 1 --format jsonl {options}"))
    }

    fn of(place: &Place, line: &str) -> Self {
        let mut command = program::command(place.path(), line);
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        Self { input: child.stdin.take().unwrap(), output: BufReader::new(child.stdout.take().unwrap()), child }
    }

    pub(crate) fn write(&mut self, text: &str) {
        self.input.write_all(text.as_bytes()).unwrap();
        self.input.flush().unwrap();
    }

    pub(crate) fn line(&mut self) -> Value {
        let mut line = String::new();
        self.output.read_line(&mut line).unwrap();
        json(&line)
    }

    pub(crate) fn end(mut self) -> Finished {
        drop(self.input);
        let mut stdout = String::new();
        self.output.read_to_string(&mut stdout).unwrap();
        let ended = Finished::new("forecast -".to_owned(), &self.child.wait_with_output().unwrap());
        Finished { stdout, ..ended }
    }
}

fn rows_of(rows: &[Row], frames: std::ops::Range<i64>) -> String {
    let here = rows.iter().copied().filter(|row| frames.contains(&row.0));
    own_tracks::csv(&here.collect::<Vec<_>>()).split_once('\n').unwrap().1.to_owned()
}

#[test]
fn every_frame_is_answered_before_the_next_one() {
    let place = Place::with_model();
    let rows = own_tracks::three_pedestrians(10);
    let expected = place.forecast(&rows, "--format jsonl").succeeds();
    let mut expected = json_lines::<Value>(&expected).into_iter();
    let mut live = LiveProgram::start(&place, "--whole --fps 25");
    live.write("frame,pedestrian,x,y\n");
    for frame in (0..100).step_by(10) {
        // An empty line ends the frame.
        live.write(&(rows_of(&rows, frame..frame + 1) + "\n"));
        if frame >= 70 {
            for _ in 0..3 {
                assert_eq!(live.line(), expected.next().unwrap());
            }
        }
    }
    let ended = live.end();
    assert_eq!(ended.stderr, "");
    assert_eq!(ended.succeeds(), "");
    assert_eq!(expected.next(), None);
}

/// A planner that writes its file anew while a stream runs.
#[test]
fn a_plan_that_cannot_be_read_keeps_the_one_before() {
    let place = Place::empty();
    let [near, far] = ["t,x,y\n0,3,0\n4.8,3,0.5\n", "t,x,y\n0,30,30\n4.8,30,31\n"];
    place.write("robot.csv", near);
    let mut live = LiveProgram::of(&place, "risk - --fps 2.5 --plan robot.csv --format jsonl");
    live.write("frame,pedestrian,x,y\n");
    let mut frames = 0..;
    let mut risk = || loop {
        let frame = frames.next().unwrap();
        live.write(&format!("{frame},1,{},0\n\n", 0.2 * f64::from(frame)));
        if frame > 7 {
            return loop {
                let line = live.line();
                if line["observed_until"] == frame {
                    break line["risk"].as_f64().unwrap();
                }
            };
        }
    };
    assert!(risk() > 0.1);
    place.write("robot.csv", far);
    assert!(risk() < 0.01);
    place.remove("robot.csv");
    assert!(risk() < 0.01);
    // A line that has no end may lack digits.
    for half in ["", "t,x,y\n0,3", "t,x,y\n0,3,0\n4.8,3,0", "t,x,y\n"] {
        place.write("robot.csv", half);
        assert!(risk() < 0.01, "{half}");
    }
    place.write("robot.csv", near);
    assert!(risk() > 0.1);
    place.write("robot.csv", "t,x,y\n7,0,0\n");
    assert!(risk() > 0.1);
    let ended = live.end();
    assert_eq!(ended.stderr.matches("the plan before goes on counting").count(), 2, "{ended:?}");
    ended.succeeds();
}

#[test]
fn one_frame_is_enough_and_a_closed_output_ends_it_quietly() {
    let place = Place::with_model();
    let rows = own_tracks::three_pedestrians(10);
    let mut live = LiveProgram::start(&place, "--one --certificate");
    live.write(&format!("frame,pedestrian,x,y\n{}\n", rows_of(&rows, 0..11)));
    let first = live.line();
    assert_eq!((&first["observed_until"], &first["unseen"]), (&0.into(), &7.into()));
    assert_eq!(first["hypotheses"].as_array().unwrap().len(), 1);
    assert_eq!(first["hypotheses"][0]["certificate"]["holds"], true);
    let LiveProgram { child, mut input, output } = live;
    drop(output);
    for frame in (20..100).step_by(10) {
        // It may have ended already.
        let _ = input.write_all((rows_of(&rows, frame..frame + 1) + "\n").as_bytes());
    }
    drop(input);
    let finished = Finished::new("forecast -".to_owned(), &child.wait_with_output().unwrap());
    let finished = finished.says("a step of 0.4 s is taken as 10 frames");
    assert_eq!(finished.stderr.lines().count(), 1, "{finished:?}");
    finished.succeeds();
}

#[test]
fn an_invalid_line_is_reported_and_earlier_frames_are_answered() {
    let place = Place::with_model();
    let good = own_tracks::csv(&own_tracks::three_pedestrians(9));
    for (bad, message) in [
        ("90,1,left,2\n", "line 29, field 3"),
        ("0,1,1,2\n", "line 29: frame 0 comes after frame 80"),
        ("80,1,1,2\n", "line 29: pedestrian 1 is in frame 80 already"),
    ] {
        let line = "forecast - --model run --whole --frame-step 10 --format jsonl";
        let finished = place.run_on(&format!("{good}{bad}"), line).says(message);
        // Frame 80, which the invalid line ends, is also forecast.
        assert_eq!((finished.stdout.lines().count(), finished.code), (6, Some(1)));
        assert!(finished.stderr.starts_with("error: standard input, "), "{finished:?}");
    }
}

#[test]
fn implausible_input_is_reported_once() {
    let place = Place::empty();
    let mut pixels = own_tracks::three_pedestrians(12);
    for row in &mut pixels {
        row.2 *= 100.0;
    }
    let line = "forecast - --threads 1 --frame-step 10";
    let finished = place.run_on(&own_tracks::csv(&pixels), &format!("{line} --one"));
    let warning = "warning: most positions are too far from the ones before";
    assert_eq!(finished.stderr.matches(warning).count(), 1, "{finished:?}");
    let mut rows = own_tracks::three_pedestrians(20);
    // From side to side, 2 m per step, two steps to each side.
    rows.extend((8..20_i64).map(|t| (10 * t, 4, t as f64, 2.0 * (t % 4 - 2).abs() as f64)));
    rows.sort_by_key(|row| (row.0, row.1));
    for options in ["", "--certificate --one"] {
        let line = format!("{line} --whole {options}");
        let finished = place.run_on(&own_tracks::csv(&rows), &line);
        let finished = finished.says("first that of pedestrian 4 observed until frame 150");
        let unlike = "motions are unlike the training motions";
        assert_eq!(finished.stderr.matches(unlike).count(), 1, "{finished:?}");
    }
}
