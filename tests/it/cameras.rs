//! Many cameras in one process: the forecasts of each are the same as if it were alone.

use crate::live::LiveProgram;
use ddl::data::{Completeness, LiveTracks, PedestrianId, PedestrianNames, Position, SceneName};
use ddl::memory::SceneMemory;
use ddl::{Ddl, DdlError, Request, Session, Variant};
use ddl_tests::own_tracks::{self, FRAME_STEP, Row};
use ddl_tests::place::{Place, json_lines};
use ddl_tests::{bits, drawn_model};
use proptest::prelude::*;
use serde_json::Value;
use std::collections::{BTreeMap, VecDeque};
use std::fmt::Write as _;
use std::sync::LazyLock;

type Seen = (i64, Vec<(PedestrianId, Position)>);

fn name(scene: &str) -> SceneName {
    SceneName::new(scene).unwrap()
}

/// The forecasts of a stream: the frame, and the bits of its forecast.
type Answers = Vec<(i64, Vec<u64>)>;

static MODEL: LazyLock<Ddl> = LazyLock::new(|| drawn_model::of(Variant::Full));

fn session() -> Session<&'static Ddl> {
    let tracks = LiveTracks::new().with_completeness(Completeness::Partial);
    Session::new(&*MODEL, tracks, Request::one()).unwrap()
}

fn alone(frames: &[Seen]) -> Answers {
    let mut session = session();
    let answers = frames.iter().filter_map(|(frame, people)| {
        let (window, answer) = session.push(*frame, people.iter().copied()).unwrap().answer?;
        Some((window.frames()[7], bits::of(answer.forecast())))
    });
    answers.collect()
}

fn observe(
    session: &mut Session<&Ddl>,
    scene: &SceneName,
    frame: i64,
    seen: &[(PedestrianId, Position)],
) -> Result<(), DdlError> {
    session.observe(Some(scene), frame, seen.iter().copied(), &PedestrianNames::default()).map(drop)
}

/// Frames of three scenes, and the order in which they arrive and are forecast.
fn streams() -> impl Strategy<Value = (Vec<Vec<Seen>>, Vec<(usize, bool)>, usize)> {
    let walk = |(scene, frame): (usize, i64), id: i64| {
        let t = frame as f64;
        let place = [0.4 * t + id as f64, 0.3 * (id as f64 + scene as f64) * t.sin()];
        (PedestrianId(id), place)
    };
    let frames = move |scene: usize| {
        let people = prop::collection::btree_set(0..4_i64, 0..4);
        prop::collection::btree_map(0..25_i64, people, 0..20).prop_map(move |frames| {
            let frames = frames.into_iter();
            let seen = frames.map(|(frame, people)| {
                let seen = people.into_iter().map(|id| walk((scene, frame), id));
                (frame, seen.collect())
            });
            seen.collect::<Vec<Seen>>()
        })
    };
    let turns = prop::collection::vec((0..3_usize, prop::bool::weighted(0.3)), 80);
    ((0..3).map(frames).collect::<Vec<_>>(), turns, 1..20_usize)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn each_scene_is_forecast_as_if_it_were_alone((frames, turns, batch) in streams()) {
        let names = ["hall", "yard", "gate"].map(name);
        let mut queues: Vec<VecDeque<&Seen>> = frames.iter().map(|it| it.iter().collect()).collect();
        let (mut scenes, mut latest) = (session(), session().latest_only());
        let mut answers = BTreeMap::<SceneName, Answers>::new();
        let mut answers_of_latest = answers.clone();
        let take = |session: &mut Session<&Ddl>, to: &mut BTreeMap<SceneName, Answers>| {
            let batch = session.next_batch(batch);
            let made = session.answer(batch.windows()).unwrap();
            for ((scene, window), answer) in batch.scenes.into_iter().zip(&batch.windows).zip(&made) {
                to.entry(scene.unwrap()).or_default().push((window.frames()[7], bits::of(answer.forecast())));
            }
        };
        let rest = (0..3).cycle().take(60).map(|scene| (scene, false));
        for (scene, forecasts) in turns.into_iter().chain(rest) {
            if let Some((frame, people)) = queues[scene].pop_front() {
                for scenes in [&mut scenes, &mut latest] {
                    observe(scenes, &names[scene], *frame, people).unwrap();
                }
            }
            if forecasts {
                take(&mut scenes, &mut answers);
                take(&mut latest, &mut answers_of_latest);
            }
        }
        while scenes.waiting().count() + latest.waiting().count() > 0 {
            take(&mut scenes, &mut answers);
            take(&mut latest, &mut answers_of_latest);
        }
        prop_assert_eq!(scenes.waiting().dropped(), 0);
        let mut dropped = 0;
        for (name, frames) in names.iter().zip(&frames) {
            let expected = alone(frames);
            let of_latest = answers_of_latest.remove(name).unwrap_or_default();
            dropped += expected.len() - of_latest.len();
            // The forecasts are those without dropped frames, and the last frame is forecast.
            let by_frame: BTreeMap<_, _> = expected.iter().cloned().collect();
            prop_assert!(of_latest.iter().all(|(frame, bits)| by_frame.get(frame) == Some(bits)));
            if let (Some(last), Some((frame, _))) = (expected.last(), frames.last())
                && last.0 == *frame
            {
                prop_assert_eq!(of_latest.last(), Some(last));
            }
            prop_assert_eq!(answers.remove(name).unwrap_or_default(), expected);
        }
        prop_assert_eq!(latest.waiting().dropped(), dropped as u64);
    }
}

#[test]
fn a_wrong_frame_of_a_scene_changes_nothing() {
    let mut scenes = Session::new(&*MODEL, LiveTracks::new(), Request::one()).unwrap();
    let seen = [(PedestrianId(1), [0.0, 0.0])];
    let both_see = |scenes: &mut Session<&Ddl>, frame| {
        for scene in ["a", "c"] {
            observe(scenes, &name(scene), frame, &seen).unwrap();
        }
    };
    for frame in 0..7 {
        both_see(&mut scenes, frame);
    }
    let error = observe(&mut scenes, &name("a"), 3, &[]).unwrap_err();
    assert!(matches!(error, DdlError::Live(_)), "{error}");
    let nowhere = [(PedestrianId(1), [f64::NAN, 0.0])];
    assert!(observe(&mut scenes, &name("d"), 0, &nowhere).is_err());
    assert!(scenes.tracks(Some(&name("d"))).is_none(), "nothing has changed");
    both_see(&mut scenes, 7);
    assert_eq!(scenes.next_batch(100).windows.len(), 2);
}

const LINE: &str = "forecast - --model run --threads 1 --frame-step 10";

/// Recordings of two scenes, whose frames alternate; the second scene begins two frames later.
fn recordings() -> [(&'static str, Vec<Row>); 2] {
    [("hall", own_tracks::three_pedestrians(12)), ("Tür, 2", own_tracks::of_scene("plaza", 0..100))]
}

/// The table of the recordings.
fn interleaved() -> String {
    let mut text = "frame,scene,pedestrian,x,y\n".to_owned();
    let mut queues = recordings().map(|(scene, rows)| (scene, VecDeque::from(rows)));
    while queues.iter().any(|(_, rows)| !rows.is_empty()) {
        for (scene, rows) in &mut queues {
            // The parts do not end with frames, so lines of one scene are between those of a frame of the other.
            for row in rows.drain(..rows.len().min(4)) {
                text += &as_csv(scene, &row);
            }
        }
    }
    text
}

fn as_csv(scene: &str, (frame, id, x, y): &Row) -> String {
    format!("{frame},\"{scene}\",{id},{x},{y}\n")
}

#[test]
fn interleaved_recordings_are_answered_as_each_alone() {
    let place = Place::with_model();
    let options = "--format jsonl --region 0.5,0.9";
    let mut expected = BTreeMap::new();
    for (scene, rows) in recordings() {
        let finished = place.run_on(&own_tracks::csv(&rows), &format!("{LINE} {options}"));
        expected.insert(scene.to_owned(), json_lines::<Value>(&finished.succeeds()));
    }
    assert!(expected.values().all(|lines| lines.len() > 20));
    let finished = place.run_on(&interleaved(), &format!("{LINE} {options}"));
    assert!(!finished.stderr.contains("error"), "{finished:?}");
    let mut answers = BTreeMap::<String, Vec<Value>>::new();
    for mut line in json_lines::<Value>(&finished.succeeds()) {
        let scene = line.as_object_mut().unwrap().remove("scene").unwrap().as_str().unwrap().to_owned();
        answers.entry(scene).or_default().push(line);
    }
    assert!(answers == expected, "other answers than alone");
}

#[test]
fn a_wrong_line_of_one_scene_leaves_the_others_as_they_are() {
    let place = Place::with_model();
    let good = interleaved();
    let answers = place.run_on(&good, &format!("{LINE} --one")).succeeds();
    let mut bad = String::new();
    for (i, line) in good.lines().enumerate() {
        let _ = writeln!(bad, "{line}");
        match i {
            20 => bad += "-5,hall,1,0,0\n",
            30 => bad += "200,,1,0,0\n",
            _ => {}
        }
    }
    let mut finished = place.run_on(&bad, &format!("{LINE} --one"));
    assert_eq!(finished.code, Some(1), "{finished:?}");
    assert!(finished.stdout == answers, "other answers than without");
    for words in [
        "line 22: frame -5 of scene hall comes after frame",
        "this is left out, and the stream goes on",
        "error: standard input: 2 lines or frames were wrong, and were left out",
    ] {
        finished = finished.says(words);
    }
}

#[test]
fn what_does_not_fit_scenes_is_refused() {
    let place = Place::with_model();
    std::fs::create_dir(place.at("memories")).unwrap();
    place.write("scenes.csv", interleaved());
    let of_another = "a file holds one recording, but this row is of another";
    place.fails("forecast scenes.csv --model run", &[of_another]);
    let tracks = own_tracks::csv(&own_tracks::three_pedestrians(9));
    let finished = place.run_on(&tracks, &format!("{LINE} --memory memories"));
    finished.says("memories is a folder, and the frames name no scenes").fails();
    let finished = place.run_on(&place.text("scenes.csv"), &format!("{LINE} --memory new.memory"));
    finished.says("new.memory is a file of one place").fails();
    assert!(!place.at("new.memory").exists());
}

#[test]
fn each_scene_has_a_memory_file_of_its_own() {
    let place = Place::with_model();
    std::fs::create_dir(place.at("memories")).unwrap();
    place.write("memories/hall.memory", "damaged");
    let text = interleaved();
    let forgetful = place.run_on(&text, &format!("{LINE} --one")).succeeds();
    let finished = place.run_on(&text, &format!("{LINE} --one --memory memories"));
    // The fault of one memory file is reported, and its scene is forecast without memory.
    assert_eq!(finished.code, Some(1), "{finished:?}");
    let told = finished.stderr.matches("hall.memory is not a readable scene memory");
    assert_eq!(told.count(), 1);
    assert_eq!(finished.stdout.lines().count(), forgetful.lines().count());
    assert_eq!(place.text("memories/hall.memory"), "damaged");
    place.remove("memories/hall.memory");
    place.run_on(&text, &format!("{LINE} --one --memory memories")).succeeds();
    let memory = |file: &str| SceneMemory::read(&place.at(&format!("memories/{file}"))).unwrap();
    let mut alone = SceneMemory::new(FRAME_STEP, SceneMemory::DEFAULT_CAPACITY).unwrap();
    for (frame, people) in own_tracks::frames(&recordings()[0].1) {
        alone.observe(frame, people).unwrap();
    }
    assert_eq!(memory("hall.memory"), alone);
    // The second scene was observed twice.
    assert!(memory("T%C3%BCr%2C%202.memory").last_frame().is_some());
}

#[test]
fn a_scene_that_falls_silent_blocks_no_other() {
    let place = Place::with_model();
    let mut live = LiveProgram::start(&place, "--frame-step 10 --one");
    // The frame is complete only at the end of the input.
    let silent = [0, 10].map(|frame| as_csv("silent", &(frame, 1, 0.0, 0.0)));
    live.write(&("frame,scene,pedestrian,x,y\n".to_owned() + &silent.concat()));
    let line = live.line();
    assert!(line["scene"] == "silent" && line["observed_until"] == 0, "{line}");
    for frame in 0..6 {
        live.write(&(as_csv("hall", &(10 * frame, 1, 0.5 * frame as f64, 0.0)) + "\n"));
        let line = live.line();
        assert!(line["scene"] == "hall" && line["observed_until"] == 10 * frame, "{line}");
    }
    let rest = json_lines::<Value>(&live.end().succeeds());
    assert_eq!(rest.len(), 1);
    assert!(rest[0]["scene"] == "silent" && rest[0]["observed_until"] == 10);
}
