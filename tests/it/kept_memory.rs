//! The memory of a place that `ddl forecast - --memory` keeps in a file, and its summary by `ddl data`.

use crate::live::LiveProgram;
use ddl::data::{LiveTracks, PedestrianNames};
use ddl::memory::{MemoryFile, SceneMemory};
use ddl::{Ddl, DeviceChoice, Note, Request, Session, SessionMemory, Variant};
use ddl_tests::own_tracks::{self, FRAME_STEP, Row};
use ddl_tests::place::{Place, json_lines};
use ddl_tests::{crowd, drawn_model};
use serde_json::{Value, json};
use std::ops::Range;

const LINE: &str = "forecast - --model run --threads 1 --whole --format jsonl --frame-step 10";
const KEPT: &str = "--memory hall.memory";

/// Pedestrians of a simulated scene, in a range of frames of 0.4 s.
fn rows(steps: Range<i64>) -> Vec<Row> {
    own_tracks::of_scene("corridor", FRAME_STEP * steps.start..FRAME_STEP * steps.end)
}

fn moved(rows: Vec<Row>) -> Vec<Row> {
    rows.into_iter().map(|(frame, id, x, y): Row| (frame, id, x + 500.0, y - 300.0)).collect()
}

/// Writes a memory of these pedestrians to a file.
fn remember(place: &Place, name: &str, rows: &[Row], frame_step: i64) {
    let mut memory = SceneMemory::new(frame_step, SceneMemory::DEFAULT_CAPACITY).unwrap();
    for (frame, positions) in own_tracks::frames(rows) {
        memory.observe(frame, positions).unwrap();
    }
    memory.write(&place.at(name)).unwrap();
}

fn kept(place: &Place, name: &str) -> SceneMemory {
    SceneMemory::read(&place.at(name)).unwrap()
}

fn hypotheses_of(live: &mut Session<&Ddl>, rows: &[Row]) -> Vec<Value> {
    let mut hypotheses = Vec::new();
    for (frame, positions) in own_tracks::frames(rows) {
        let Some((window, answer)) = live.push(frame, positions).unwrap().answer else {
            continue;
        };
        let forecast = answer.forecast();
        for i in 0..window.len() {
            let hypothesis = |k: usize| json!([forecast.weight(i, k), forecast.hypothesis(i, k)]);
            hypotheses.push((0..forecast.hypotheses()).map(hypothesis).collect::<Value>());
        }
    }
    hypotheses
}

fn hypotheses_in(lines: &str) -> Vec<Value> {
    let hypotheses_of_line = |line: Value| -> Value {
        line["hypotheses"].as_array().unwrap().iter().map(|one| json!([one["weight"], one["positions"]])).collect()
    };
    json_lines::<Value>(lines).into_iter().map(hypotheses_of_line).collect()
}

#[test]
fn a_stream_cut_in_two_continues_with_its_memory() {
    let place = Place::with_model();
    let model = Ddl::load(&place.at("run"), DeviceChoice::Cpu).unwrap();
    let live = Session::new(&model, LiveTracks::with_frame_step(FRAME_STEP).unwrap(), Request::default()).unwrap();
    let mut live = live.remembering(SessionMemory::Kept).unwrap();
    let [first, second] = [rows(0..50), rows(50..90)];
    // An invalid line ends the first part; the memory until then is kept.
    let input = own_tracks::csv(&first) + "500,1,left,2\n";
    let before = place.run_on(&input, &format!("{LINE} {KEPT}")).says("line ");
    assert_eq!(before.code, Some(1), "{before:?}");
    assert_eq!(hypotheses_in(&before.stdout), hypotheses_of(&mut live, &first));
    assert_eq!(&kept(&place, "hall.memory"), live.place(None).unwrap().memory());
    // A session that ends with `clear` is kept as well.
    live.clear(None);
    let (mut file, _) = MemoryFile::open(&place.at("cleared.memory")).unwrap();
    assert_eq!(file.end(live.place(None).unwrap().clone()).unwrap(), None);
    assert_eq!(kept(&place, "cleared.memory").summary().frames, 50);
    let input = own_tracks::csv(&second);
    let after = place.run_on(&input, &format!("{LINE} {KEPT}")).succeeds();
    let after = hypotheses_in(&after);
    assert_eq!(after, hypotheses_of(&mut live, &second));
    let forgetful = place.run_on(&input, LINE).succeeds();
    assert!(after.len() > 20 && after != hypotheses_in(&forgetful));
    assert_eq!(&kept(&place, "hall.memory"), live.place(None).unwrap().memory());
    // A frame rate inferred from the first two frames is as good as a given one.
    let learned = "forecast - --model run --threads 1 --whole --format jsonl --memory learned.memory";
    place.run_on(&own_tracks::csv(&first), learned).succeeds();
    assert_eq!(kept(&place, "learned.memory").summary().frames, 50);
}

#[test]
fn a_memory_of_another_place_stays_as_it_is() {
    let place = Place::with_model();
    remember(&place, "hall.memory", &rows(0..300), FRAME_STEP);
    let before = place.read("hall.memory");
    for (steps, words) in
        [(200, "the memory is of another place"), (40, "too few to tell whether the memory is of this place")]
    {
        let elsewhere = own_tracks::csv(&moved(rows(0..steps)));
        let finished = place.run_on(&elsewhere, &format!("{LINE} {KEPT}"));
        assert_eq!(finished.code, Some(0), "{finished:?}");
        assert_eq!(finished.stderr.matches(words).count(), 1, "{finished:?}");
        assert_eq!(finished.stderr.matches("hall.memory").count(), 1);
        assert!(place.read("hall.memory") == before, "{steps} steps");
    }
    let here = own_tracks::csv(&rows(300..400));
    let finished = place.run_on(&here, &format!("{LINE} {KEPT}"));
    assert!(!finished.stderr.contains("place"), "{finished:?}");
    finished.succeeds();
    assert!(place.read("hall.memory") != before);
}

#[test]
fn a_tracker_that_restarts_elsewhere_does_not_free_the_file() {
    let place = Place::with_model();
    remember(&place, "hall.memory", &rows(0..300), FRAME_STEP);
    let before = place.read("hall.memory");
    let model = Ddl::load(&place.at("run"), DeviceChoice::Cpu).unwrap();
    let tracks = LiveTracks::with_frame_step(FRAME_STEP).unwrap();
    let session = Session::new(&model, tracks, Request::default()).unwrap().latest_only();
    let mut session = session.remembering(SessionMemory::in_file(&place.at("hall.memory")).unwrap()).unwrap();
    for steps in [200, 50] {
        session.clear(None);
        for (frame, seen) in own_tracks::frames(&moved(rows(0..steps))) {
            session.observe(None, frame, seen, &PedestrianNames::default()).unwrap();
        }
    }
    let notes: Vec<String> = session.close().iter().map(Note::line).collect();
    assert!(notes.len() == 1 && notes[0].contains("the memory is of another place"), "{notes:?}");
    assert!(place.read("hall.memory") == before);
}

#[test]
fn unusable_memory_files_are_refused_at_once_and_not_overwritten() {
    let place = Place::with_model();
    remember(&place, "slow.memory", &rows(0..30), 1);
    place.write("damaged.memory", &place.read("slow.memory")[..900]);
    place.write("folder/hall.memory", "");
    let before = ["slow.memory", "damaged.memory", "tracks.csv"].map(|file| place.read(file));
    let input = own_tracks::csv(&rows(0..12));
    let cases = "
slow.memory => slow.memory: the memory was made at 2.5 frames per second
damaged.memory => damaged.memory is not a readable scene memory
tracks.csv => tracks.csv is not a readable scene memory
folder => folder is a folder, and the frames name no scenes
nowhere/hall.memory => cannot write nowhere/hall.memory
";
    for case in cases.trim().lines() {
        let (file, words) = case.split_once(" => ").unwrap();
        place.run_on(&input, &format!("{LINE} --memory {file}")).says(words).fails();
    }
    // The memory would overwrite the forecasts.
    place.run_on(&input, &format!("{LINE} {KEPT} --output hall.memory")).says("would be lost").fails();
    let after = ["slow.memory", "damaged.memory", "tracks.csv"].map(|file| place.read(file));
    assert!(before == after);
    let damaged = "damaged.memory is not a readable scene memory";
    place.fails("data damaged.memory --svg hall.svg", &[damaged]);
    // The other files are summarised nevertheless.
    let finished = place.run("data damaged.memory tracks.csv");
    assert_eq!(finished.code, Some(1));
    assert!(finished.stdout.starts_with("tracks.csv\n"), "{finished:?}");
    assert!(finished.stderr.starts_with("error: damaged.memory"), "{finished:?}");
}

/// A link is followed, even if its target does not exist yet, and the lock is that of the target.
#[cfg(unix)]
#[test]
fn a_link_is_followed() {
    let place = Place::with_model();
    std::os::unix::fs::symlink("hall.memory", place.at("link.memory")).unwrap();
    let input = own_tracks::csv(&rows(0..60));
    place.run_on(&input, &format!("{LINE} --memory link.memory")).says("link.memory remembers").succeeds();
    assert!(std::fs::symlink_metadata(place.at("link.memory")).unwrap().is_symlink());
    assert!(!place.read("hall.memory").is_empty() && place.at("hall.memory.lock").is_file());
}

#[test]
fn a_model_without_a_memory_branch_is_refused_before_anything_is_read() {
    let place = Place::empty();
    let mut config = drawn_model::config(Variant::Full);
    config.goals.proposal.as_mut().unwrap().network.memory = None;
    let windows = crowd::training_windows().into_iter().step_by(50);
    drawn_model::write(config, &windows.collect::<Vec<_>>(), &place.at("run"));
    place.fails("forecast - --model run --memory hall.memory", &["has no memory branch"]);
}

#[test]
fn a_second_program_is_refused_and_a_stopped_one_writes_its_memory() {
    let place = Place::with_model();
    let mut first = LiveProgram::start(&place, &format!("--whole --frame-step 10 {KEPT}"));
    first.write(&(own_tracks::csv(&rows(0..30)) + "\n"));
    assert!(first.line()["observed_until"].is_i64());
    place.run_on("", &format!("{LINE} {KEPT}")).says("another process, or a watch of this process").fails();
    #[cfg(unix)]
    {
        use ddl_tests::processes;
        processes::signal(first.child.id(), "TERM");
        assert_eq!(first.end().code, Some(130));
        assert!(kept(&place, "hall.memory").summary().frames >= 8);
    }
    #[cfg(not(unix))]
    drop(first);
}

#[test]
fn data_draws_a_memory() {
    let place = Place::with_model();
    remember(&place, "hall.memory", &rows(0..200), FRAME_STEP);
    let _ = place.ok("data hall.memory --svg hall.svg");
    let drawn = place.text("hall.svg");
    let parts = r#"<svg| of at most 20000 segments|class="walked w4"|class="come"|class="leave"|x (m)"#;
    for part in parts.split('|') {
        assert!(drawn.contains(part), "{part}");
    }
    let cases = "
tracks.csv --svg hall.svg => but 0 were given
hall.memory hall.memory --svg both.svg => 2 were given
hall.memory --svg hall.memory => would be lost
";
    place.all_fail("data", cases);
}
