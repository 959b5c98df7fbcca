//! Goals trained alone, measured and drawn; and that they see nothing of the future.

use ddl::data::Window;
use ddl::{GoalEvaluation, GoalModel, Variant};
use ddl_tests::{crowd, program, tiny_model, wild_future};

const TRAIN: &str = "train --convention simulated --fold plaza --epochs 1 --train-walkers 40 --batch-walkers 20 \
                     --proposal-steps 8 --validation 0.25 --validation-recordings crossing --threads 1 --out run";

#[test]
fn goals_are_measured_and_drawn_before_the_network_is_trained() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let run = |command: &str| program::run(here, command).succeeds();
    let _ = run(&format!("{TRAIN} --only-goals"));
    assert!(here.join("run/proposal.safetensors").is_file());
    assert!(!here.join("run/model.safetensors").exists());

    let measured = |on: &str, more: &str| -> GoalEvaluation {
        let command = format!("goals --model run --measure {on} --json --threads 1 {more}");
        serde_json::from_str(&run(&command)).unwrap()
    };
    let test = measured("test", "--svg goals.svg");
    assert_eq!(test.recordings.keys().collect::<Vec<_>>(), ["plaza"]);
    assert_eq!((test.clusters, test.recordings["plaza"]), (20, test.all));
    assert!(test.all.walkers > 100);
    assert!(test.all.oracle_fde > 0.01 && test.all.oracle_fde < test.all.likeliest_fde);
    let calibration = test.calibration.unwrap();
    assert!(calibration.log_loss.is_finite() && calibration.bins.len() == 10);
    let svg = std::fs::read_to_string(here.join("goals.svg")).unwrap();
    assert!(svg.contains("<svg") && svg.contains("plaza, frame") && svg.contains("m off"));

    // all of the recording set apart, the ends of the others, nothing of the test scene
    let validation = measured("validation", "");
    let names: Vec<&str> = validation.recordings.keys().map(String::as_str).collect();
    assert_eq!(names, ["bottleneck", "corridor", "crossing", "doorway"]);
    let walkers = |name: &str| validation.recordings[name].walkers;
    let whole = crowd::dataset().recording("crossing").unwrap().clone();
    let whole = whole.windows(ddl::data::WindowRule::Complete);
    assert_eq!(
        walkers("crossing"),
        whole.iter().map(Window::len).sum::<usize>()
    );
    assert!(
        validation.windows.contains("crossing whole"),
        "{}",
        validation.windows
    );

    // the same command without --only-goals goes on, and the goals stay
    let before = std::fs::read(here.join("run/proposal.safetensors")).unwrap();
    let _ = run(TRAIN);
    assert!(here.join("run/model.safetensors").is_file());
    assert!(std::fs::read(here.join("run/proposal.safetensors")).unwrap() == before);
    let again = measured("test", "");
    assert_eq!((again.all, again.recordings), (test.all, test.recordings));
    let words = run("goals --model run --measure test --threads 1");
    let all = format!("{:.3}", test.all.oracle_fde);
    assert!(
        words.contains("nearest goal off") && words.contains(&all),
        "{words}"
    );
}

#[test]
fn no_future_changes_a_goal() {
    let tiny = tiny_model::folder(Variant::Full);
    let model = GoalModel::load(tiny.path(), ddl::DeviceChoice::Cpu).unwrap();
    for window in crowd::windows(2, 4) {
        let goals = |window: &Window| model.goals(std::slice::from_ref(window)).unwrap();
        let reference = goals(&window.without_future());
        for (future, changed) in wild_future::all(&window) {
            assert!(goals(&changed) == reference, "{future}");
        }
    }
}

#[test]
fn what_cannot_be_measured_is_said() {
    let folder = tiny_model::folder(Variant::Full);
    let fails = |command: &str, words: &str| {
        let finished = program::run(folder.path(), command);
        assert_ne!(finished.code, Some(0), "{finished:#?}");
        assert!(finished.stderr.contains(words), "{finished:#?}");
    };
    fails("goals --model .", "TRACKS");
    fails(
        "goals --model . --measure validation",
        "--validation-recordings",
    );
    fails(
        "goals --model . tracks.csv --measure test",
        "cannot be used with",
    );
    fails("goals --model . tracks.csv --svg goals.svg", "--measure");
    fails(
        "goals --model . --measure test --last",
        "cannot be used with",
    );
    fails("goals --model . --last", "TRACKS");
    std::fs::remove_file(folder.path().join("proposal.safetensors")).unwrap();
    fails("goals --model . --measure test", "has no goals yet");
    let config = folder.path().join("config.json");
    std::fs::write(&config, r#"{"format": 1, "star": {}}"#).unwrap();
    fails(
        "goals --model . --measure test",
        &format!("has layout 1, this program reads {}", ddl::FORMAT),
    );
}
