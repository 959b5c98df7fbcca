//! The leak test on the numbers that are reported: scores that measure a forecast against itself
//! (its goals, its collisions) must not change with the true futures under `fair` and `single`, and
//! do under `published`.

use ddl::data::{Convention, Dataset, Observation, Position};
use ddl::eval::{ResultRow, Scores};
use ddl::{Ddl, DeviceChoice, EvaluationRequest, EvaluationSplit, Protocol, Variant};
use ddl_tests::{crowd, tiny_model, wild_future};
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::Path;

/// The convention whose windows of 20 frames stand alone: one window is the whole test scene.
const CONVENTION: Convention = Convention::SocialGan;
const TEST_SCENE: &str = "hotel";

/// Simulated people in the files of the convention; the test scene is one window, in which `future`
/// places everybody after the observation.
fn write_recordings(folder: &Path, future: impl Fn(usize, usize, Position) -> Position) {
    let dataset = crowd::dataset();
    let mut scenes = dataset.recordings().iter().cycle();
    for (name, file) in CONVENTION.recording_names().zip(CONVENTION.file_names()) {
        let text = if name == TEST_SCENE {
            let window = &crowd::windows(1, 8)[0];
            let changed = wild_future::replaced(window, &future);
            let people = (0_i64..).zip(0..changed.len());
            lines(people.flat_map(|(pedestrian, i)| {
                let frames = (0_i64..).map(|t| 10 * t).zip(changed.track(i));
                frames.map(move |(frame, &position)| (frame, pedestrian, position))
            }))
        } else {
            let scene = scenes.next().expect("a cycle never ends");
            let row = |o: &Observation| (o.frame, o.pedestrian.0, o.position);
            lines(scene.observations().iter().take(3000).map(row))
        };
        std::fs::write(folder.join(file), text).unwrap();
    }
}

fn lines(rows: impl Iterator<Item = (i64, i64, Position)>) -> String {
    let mut text = String::new();
    for (frame, pedestrian, [x, y]) in rows {
        writeln!(text, "{frame}\t{pedestrian}\t{x}\t{y}").unwrap();
    }
    text
}

fn evaluate(model: &Ddl, dataset: &Dataset) -> Vec<ResultRow> {
    let request = EvaluationRequest {
        protocols: Protocol::ALL.to_vec(),
        on: EvaluationSplit::Test,
        validation_recordings: Vec::new(),
        test_walkers: None,
        commit: String::new(),
    };
    ddl::evaluate(model, dataset, &request, |_| ControlFlow::Continue(()))
        .unwrap()
        .rows
}

/// What a forecast says of itself, without the truth: bit by bit.
fn of_the_forecast_alone(scores: &Scores) -> Vec<u64> {
    let mut numbers = vec![scores.collision_rate];
    if let Some(stability) = scores.stability {
        numbers.extend([
            stability.rollouts as f64,
            stability.decreasing,
            stability.end_distance,
            stability.largest_turn,
            stability.reversing,
        ]);
    }
    numbers.into_iter().map(f64::to_bits).collect()
}

#[test]
fn reported_numbers_of_a_forecast_do_not_depend_on_the_future() {
    let folder = tempfile::tempdir().unwrap();
    let data = |name: &str, future: &dyn Fn(usize, usize, Position) -> Position| {
        let folder = folder.path().join(name);
        std::fs::create_dir(&folder).unwrap();
        write_recordings(&folder, future);
        Dataset::load(CONVENTION, &folder).unwrap()
    };
    let as_it_was = data("true", &|_, _, p| p);
    let changed = data("changed", &|i, t, p| {
        [4.0 + p[1] + i as f64, p[0] - 0.7 * t as f64]
    });
    let run = folder.path().join("run");
    let request = tiny_model::request(TEST_SCENE, Variant::Full, 80, &run);
    tiny_model::train(&request, &as_it_was);
    let model = Ddl::load(&run, DeviceChoice::Cpu).unwrap();
    let (before, after) = (evaluate(&model, &as_it_was), evaluate(&model, &changed));
    assert_eq!(before.len(), after.len());
    let mut published_changes = 0;
    for (before, after) in before.iter().zip(&after) {
        assert_eq!(before.conditions, after.conditions);
        let what = format!(
            "{} {}",
            before.conditions.protocol,
            before.conditions.label()
        );
        assert_ne!(
            before.scores.min_ade.to_bits(),
            after.scores.min_ade.to_bits(),
            "{what}: the futures were not changed"
        );
        let same = of_the_forecast_alone(&before.scores) == of_the_forecast_alone(&after.scores);
        if before.conditions.protocol == Protocol::Published {
            published_changes += usize::from(!same);
        } else {
            assert!(
                same,
                "{what}: {:#?} became {:#?}",
                before.scores, after.scores
            );
        }
    }
    assert!(published_changes > 0, "the published goals know the future");
}
