//! Training on own recordings beside the built-in models: what is measured on the validation part, and weights to begin with.

use ddl::{RunConfig, RunDirectory};
use ddl_tests::own_tracks::{self, Row};
use ddl_tests::program;
use serde_json::Value;
use std::path::Path;

/// Options that make a training one of seconds.
const SMALL: &str = "--train-walkers 64 --batch-walkers 16 --proposal-steps 5 --threads 1";

/// A simulated crowd cut into clips of so many frames (10 a step), as csv files in the folder `clips`.
fn clips(folder: &Path, scene: &str, frames: i64, count: i64) {
    let crowds = ddl_tests::crowd::dataset();
    let recording = crowds.recording(scene).unwrap();
    std::fs::create_dir(folder.join("clips")).unwrap();
    for clip in 0..count {
        let begin = clip * frames;
        let seen = recording.observations().iter();
        let rows: Vec<Row> = seen
            .filter(|seen| (begin..begin + frames).contains(&seen.frame))
            .map(|seen| {
                let [x, y] = seen.position;
                (seen.frame, seen.pedestrian.0, x, y)
            })
            .collect();
        let file = folder.join(format!("clips/clip{clip}.csv"));
        std::fs::write(file, own_tracks::csv(&rows)).unwrap();
    }
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// minADE and pedestrians of the first row of a report.
fn first_row(report: &Value) -> (f64, u64) {
    let scores = &report["rows"][0]["scores"];
    let (min_ade, pedestrians) = (&scores["min_ade"], &scores["pedestrians"]);
    (min_ade.as_f64().unwrap(), pedestrians.as_u64().unwrap())
}

/// Training, `ddl evaluate` of the run and of the built-in model tell the same numbers of the same windows, also where there are more
/// pedestrians than epochs are chosen by.
#[test]
fn training_and_evaluation_measure_alike() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    clips(folder, "plaza", 2000, 2);
    let run = |command_line: &str| program::run(folder, command_line);
    let kept = "--data clips --validation-recordings clip1";
    let train = format!("train {kept} --out run --epochs 1 {SMALL} --json --progress none");
    let trained = json(&run(&train).succeeds());
    let told = &trained["validation"];
    for (model, part) in [("run", "run"), ("hotel", "builtin")] {
        let evaluate = format!(
            "evaluate --model {model} {kept} --validation --protocol fair --threads 1 --json --progress none"
        );
        let (min_ade, pedestrians) = first_row(&json(&run(&evaluate).succeeds()));
        assert!(pedestrians > 1000, "{pedestrians}");
        assert_eq!(told["pedestrians"].as_u64(), Some(pedestrians));
        let said = told[part]["min_ade"].as_f64().unwrap();
        assert!((said - min_ade).abs() < 1e-9, "{model}: {said} {min_ade}");
    }
    assert_eq!(trained["validation_min_ade"], told["run"]["min_ade"]);
    // And in words, by the same command again.
    let words = run(&train.replace(" --json", "")).succeeds();
    for part in ["run", "builtin"] {
        let errors = ["min_ade", "min_fde"].map(|error| told[part][error].as_f64().unwrap());
        let errors = format!("{:.3}/{:.3}", errors[0], errors[1]);
        assert!(words.contains(&errors), "{errors}: {words}");
    }
    assert!(words.contains("training "), "{words}");
    // Another part than its own would hold what it has learned from.
    let other = run("evaluate --model run --data clips --validation --validation-recordings clip0");
    assert!(other.fails().contains("leave --validation-recordings out"));
}

/// Weights to begin with are an epoch like the others: what comes of them is no worse where it was chosen.
#[test]
fn a_training_begins_with_another_models_weights() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    clips(folder, "plaza", 1500, 2);
    let run = |command_line: &str| program::run(folder, command_line);
    // Steps that destroy more than they mend.
    let train =
        format!("train --data clips --from hotel --epochs 2 --learning-rate 0.05 {SMALL} --json");
    let trained = json(&run(&format!("{train} --out run")).succeeds());
    assert_eq!(trained["kept_epoch"], 0);
    let directory = RunDirectory::new(folder.join("run"));
    let config: RunConfig = directory.config().unwrap();
    let from = config.from.unwrap();
    assert_eq!(
        (from.model.as_str(), from.sha256.len()),
        ("hotel (built in)", 64)
    );
    let epochs = directory.metrics().unwrap();
    let errors: Vec<f64> = epochs
        .iter()
        .map(|epoch| epoch.validation.unwrap())
        .collect();
    assert_eq!(
        epochs.iter().map(|epoch| epoch.epoch).collect::<Vec<_>>(),
        [0, 1, 2]
    );
    assert!(errors[0] < errors[1].min(errors[2]), "{errors:?}");
    assert_eq!(directory.kept_epochs().unwrap(), [0]);
    // Stopped after the goals, then finished by the same command: the same bytes.
    for half in ["--only-goals", ""] {
        let _ = run(&format!("{train} --out halves {half}")).succeeds();
    }
    let weights = |run: &str| std::fs::read(folder.join(run).join("model.safetensors")).unwrap();
    assert_eq!(weights("run"), weights("halves"));
    // A run and a packed one can be begun with as well; other weights are another run.
    let _ = run("pack --model run --out packed.safetensors").succeeds();
    for model in ["run", "packed.safetensors"] {
        let train = train.replace("hotel", model);
        let _ = run(&format!("{train} --out of-{model}")).succeeds();
        let message = run(&format!("{train} --out run")).fails();
        assert!(
            message.contains("holds another run: its from.model"),
            "{message}"
        );
    }
    let _ = run("evaluate --model run --data clips --validation --protocol fair --threads 1")
        .succeeds();
    let _ = run("report run --out report").succeeds();
}

#[test]
fn weights_of_other_sizes_are_refused() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    clips(folder, "plaza", 1500, 2);
    for (options, words) in [
        (
            "--feed-forward-width 16",
            "star.feed_forward_width is 128, not 16 as asked for",
        ),
        (
            "--variant no-goal-shift",
            "star.frame is goal, not world as asked for",
        ),
        (
            "--recipe published",
            "star.feed_forward_width is 128, not 2048 as asked for",
        ),
    ] {
        let command_line = format!("train --data clips --from hotel {options} --out run {SMALL}");
        let message = program::run(folder, &command_line).fails();
        assert!(
            message.contains("hotel (built in)") && message.contains(words),
            "{message}"
        );
        assert!(
            !folder.join("run").exists(),
            "{command_line} left a run behind"
        );
    }
    let message = program::run(folder, "train --data clips --from nowhere --out run").fails();
    assert!(message.contains("nowhere"), "{message}");
}

/// Clips of 12 s: their last fifths hold no window of 8 s, and too few windows to learn all from.
#[test]
fn short_clips_are_validated_on_whole_and_begin_with_the_builtin_model() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    clips(folder, "plaza", 300, 6);
    let run = |command_line: &str| program::run(folder, command_line);
    let train = format!("train --data clips --out run --epochs 1 {SMALL}");
    let finished = run(&train);
    let told = finished.stderr.clone();
    assert!(
        told.contains("(--validation-recordings clip1,clip4)"),
        "{told}"
    );
    assert!(
        told.contains("weights of the built-in model hotel (--from none"),
        "{told}"
    );
    let _ = finished.succeeds();
    let config: RunConfig = RunDirectory::new(folder.join("run")).config().unwrap();
    assert_eq!(config.data.validation_recordings, ["clip1", "clip4"]);
    assert_eq!((config.data.validation, config.patience), (0.0, Some(10)));
    // The built-in model is measured on the same clips, named by nobody.
    for data in ["--model run --data clips", "--data clips"] {
        let evaluate = format!("evaluate {data} --validation --protocol fair --threads 1");
        let words = run(&evaluate).succeeds();
        let recordings: Vec<&str> = words
            .lines()
            .filter(|line| line.starts_with("clip"))
            .collect();
        assert_eq!(recordings.len(), 2, "{words}");
        assert!(recordings[0].starts_with("clip1 ") && recordings[1].starts_with("clip4 "));
        assert!(
            words.contains("\nvalidation: clip1, clip4 whole\n"),
            "{words}"
        );
    }
}

/// A recording whose last fifth holds no window of 8 s: its run cannot be measured on that.
#[test]
fn an_empty_validation_part_is_no_result() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    clips(folder, "plaza", 900, 1);
    let run = |command_line: &str| program::run(folder, command_line);
    let train = format!("train --data clips --out run --epochs 1 --from none {SMALL}");
    let message = run(&train).fails();
    assert!(
        message.contains("--validation 0.4") && !message.contains("--validation-recordings"),
        "{message}"
    );
    let _ = run(&format!("{train} --patience 0")).succeeds();
    let of = "--model run --data clips --threads 1";
    for command_line in [
        format!("evaluate {of} --validation"),
        format!("goals {of} --measure validation"),
    ] {
        let message = run(&command_line).fails();
        assert!(
            message.contains("--validation 0.4") && message.contains("20 steps in a row"),
            "{message}"
        );
    }
}

#[test]
fn recordings_of_a_folder_have_a_row_each() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    clips(folder, "plaza", 300, 3);
    let run = |command_line: &str| program::run(folder, command_line);
    let words = run("evaluate --data clips --protocol fair --threads 1 --out report").succeeds();
    assert!(words.contains("3 recordings, clip0 to clip2"), "{words}");
    assert!(!words.contains("clip0+"), "{words}");
    let by_recording = words.split("\nrecording ").nth(1).unwrap();
    for clip in ["clip0", "clip1", "clip2"] {
        let lines = by_recording.lines().filter(|line| line.starts_with(clip));
        assert_eq!(lines.count(), 1, "{words}");
    }
    let page = std::fs::read_to_string(folder.join("report/report.md")).unwrap();
    assert!(
        page.contains("By recording") && page.contains("| clip2 "),
        "{page}"
    );

    let measured = run("goals --measure test --data clips --json --progress none --threads 1");
    let measured = json(&measured.succeeds());
    assert_eq!(measured["fold"], "3 recordings, clip0 to clip2");
    assert_eq!(measured["recordings"].as_object().unwrap().len(), 3);
    let of_part = run("goals --measure validation --data clips --threads 1").succeeds();
    assert!(
        of_part.contains("clip1") && !of_part.contains("clip2"),
        "{of_part}"
    );
}

/// Every command that reports takes both, so that programs need not know which has a bar.
#[test]
fn results_for_programs_and_progress_go_together() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    clips(folder, "plaza", 300, 1);
    for command_line in [
        "data clips",
        "info",
        "evaluate --data clips --protocol single --threads 1",
    ] {
        let finished = program::run(folder, &format!("{command_line} --json --progress none"));
        let _ = json(&finished.succeeds());
    }
}
