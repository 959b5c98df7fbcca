//! A user's own recordings: `ddl data`, `ddl train --data`, `ddl evaluate --convention own`.

use ddl::{RunConfig, RunDirectory};
use ddl_tests::own_tracks::{self, Row};
use ddl_tests::program;
use std::path::Path;

/// Options that make a training one of seconds.
const SMALL: &str =
    "--from none --epochs 3 --train-walkers 64 --batch-walkers 16 --proposal-steps 20 --threads 1";

/// Recordings of the simulated crowds as csv, as somebody may have them: two files in a folder.
fn recordings(folder: &Path) {
    let crowds = ddl_tests::crowd::dataset();
    std::fs::create_dir(folder.join("mine")).unwrap();
    for (name, scene) in [("lobby", "corridor"), ("yard", "plaza")] {
        let recording = crowds.recording(scene).unwrap();
        let rows: Vec<Row> = recording
            .observations()
            .iter()
            .filter(|seen| seen.frame < 1500)
            .map(|seen| {
                let [x, y] = seen.position;
                (seen.frame, seen.pedestrian.0, x, y)
            })
            .collect();
        let file = folder.join("mine").join(format!("{name}.csv"));
        std::fs::write(file, own_tracks::csv(&rows)).unwrap();
    }
    std::fs::write(folder.join("mine/README.md"), "not a recording").unwrap();
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

#[test]
fn own_recordings_are_told_trained_on_and_measured_with() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    recordings(folder);
    let run = |command_line: &str| program::run(folder, command_line);

    let told = json(&run("data mine --json").succeeds());
    let each = told["recordings"].as_array().unwrap();
    assert_eq!(each.len(), 2);
    assert_eq!(each[0]["recording"], "lobby");
    assert_eq!(each[0]["frame_step"], 10);
    let windows = |of: &serde_json::Value| of["to_learn_from"].as_u64().unwrap();
    assert!(windows(&each[1]) > 100, "{told}");
    let total = windows(&told["total"]);
    assert_eq!(total, windows(&each[0]) + windows(&each[1]));
    let words = run("data mine").succeeds();
    let in_all = format!(" {total} pedestrian-windows in ");
    assert!(words.lines().last().unwrap().contains(&in_all), "{words}");

    let trained = json(&run(&format!("train --data mine --out run {SMALL} --json")).succeeds());
    let run_directory = RunDirectory::new(folder.join("run"));
    let config: RunConfig = run_directory.config().unwrap();
    assert_eq!(config.data.fold, "none");
    assert_eq!((config.data.validation, config.patience), (0.2, Some(10)));
    let epochs = run_directory.metrics().unwrap();
    assert_eq!(epochs.len(), 3);
    let errors: Vec<f64> = epochs.iter().map(|e| e.validation.unwrap()).collect();
    let best = (0..3)
        .min_by(|&a, &b| errors[a].total_cmp(&errors[b]))
        .unwrap()
        + 1;
    assert_eq!(trained["kept_epoch"], best);
    // The best epoch is the model, and the others are not kept.
    assert_eq!(run_directory.kept_epochs().unwrap(), [best]);
    let weights = |file: &Path| std::fs::read(file).unwrap();
    assert_eq!(
        weights(&run_directory.model()),
        weights(&run_directory.epoch(best))
    );

    // The number that the epoch was chosen by is the one that the evaluation reports.
    let measured =
        run("evaluate --model run --data mine --validation --protocol fair --threads 1 --json");
    let report = json(&measured.succeeds());
    let row = &report["rows"][0];
    assert_eq!(row["conditions"]["convention"], "own");
    assert_eq!(
        row["conditions"]["selection"],
        "epoch of the least validation error"
    );
    // Few enough for all of them to have been measured after each epoch.
    let walkers = row["scores"]["pedestrians"].as_u64().unwrap();
    assert!((50..=1000).contains(&walkers), "{walkers}");
    let min_ade = row["scores"]["min_ade"].as_f64().unwrap();
    assert!(
        (min_ade - errors[best - 1]).abs() < 1e-9,
        "{min_ade} {errors:?}"
    );

    what_it_learned_from_is_no_test(folder);
    // Its results are kept with it, and make a report.
    let _ = run("report run --out report").succeeds();
    assert!(folder.join("report/report.html").is_file());
    a_damaged_best_epoch_is_named(folder, &run_directory);
    // A hole in the record would choose among some of the epochs.
    std::fs::remove_file(run_directory.model()).unwrap();
    std::fs::remove_file(folder.join("run/metrics.jsonl")).unwrap();
    let message = run(&format!("train --data mine --out run {SMALL}")).fails();
    assert!(message.contains("no record of epoch 1"), "{message}");
    // Any model can be measured on recordings it does not know.
    let other = run(
        "evaluate --model hotel --convention own --data mine/yard.csv --test-walkers 40 --protocol single --threads 1",
    );
    let told = other.succeeds();
    assert!(
        told.contains("convention own, protocol single") && told.contains("yard"),
        "{told}"
    );
}

/// The sound files are told of, and the broken ones named, so that they can be mended at once.
#[test]
fn files_that_cannot_be_read_are_named_together() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    recordings(folder);
    std::fs::write(
        folder.join("mine/roof.csv"),
        "frame,pedestrian,x,y\n1,1,a,0\n",
    )
    .unwrap();
    let run = |command_line: &str| program::run(folder, command_line);
    let told = run("data mine");
    assert_eq!(told.code, Some(1));
    for name in ["lobby", "yard"] {
        assert!(
            told.stdout.contains(&format!("mine/{name}.csv")),
            "{told:?}"
        );
    }
    assert!(told.stderr.starts_with("error: mine/roof.csv"), "{told:?}");

    for index in 0..11 {
        std::fs::write(folder.join(format!("mine/empty{index}.txt")), "").unwrap();
    }
    for command_line in ["data mine", "train --data mine --out run"] {
        let told = run(command_line);
        assert_eq!(told.code, Some(1));
        let lines: Vec<&str> = told.stderr.lines().collect();
        assert!(
            lines.iter().all(|line| line.starts_with("error: ")),
            "{told:?}"
        );
        assert!(lines[0].contains("mine/empty0.txt"), "{told:?}");
        assert_eq!(
            (lines.len(), lines[10]),
            (
                11,
                "error: 12 of 14 files cannot be read; the first 10 are named above"
            )
        );
    }
    assert!(!folder.join("run").exists());
    let told = run("data mine --json");
    assert_eq!(
        (told.code, &json(&told.stdout)["total"]["recordings"]),
        (Some(1), &serde_json::json!(2))
    );
}

/// Whatever it is called, and alone too.
fn what_it_learned_from_is_no_test(folder: &Path) {
    let run = |command_line: &str| program::run(folder, command_line);
    std::fs::copy(folder.join("mine/yard.csv"), folder.join("renamed.csv")).unwrap();
    for data in ["mine", "mine/lobby.csv", "renamed.csv"] {
        let command_line = format!("evaluate --model run --data {data} --threads 1");
        let message = run(&command_line).fails();
        assert!(message.contains("was trained on"), "{message}");
    }
    // A file of that name that is only cut, resampled or rounded would be no test.
    std::fs::create_dir(folder.join("other")).unwrap();
    let text = std::fs::read_to_string(folder.join("mine/yard.csv")).unwrap();
    let cut: Vec<&str> = text.lines().take(text.lines().count() - 1).collect();
    std::fs::write(folder.join("other/yard.csv"), cut.join("\n")).unwrap();
    let message = run("evaluate --model run --data other --threads 1").fails();
    assert!(
        message.contains("called \"yard\" as well") && message.contains("another name"),
        "{message}"
    );
}

/// The best epoch is read before it becomes the model: nothing else is removed.
fn a_damaged_best_epoch_is_named(folder: &Path, run_directory: &RunDirectory) {
    let run = |command_line: &str| program::run(folder, command_line);
    std::fs::remove_file(run_directory.model()).unwrap();
    let best = run_directory.epoch(run_directory.kept_epochs().unwrap()[0]);
    let whole = std::fs::read(&best).unwrap();
    let mut damaged = whole.clone();
    *damaged.last_mut().unwrap() ^= 1;
    std::fs::write(&best, &damaged).unwrap();
    let message = run(&format!("train --data mine --out run {SMALL}")).fails();
    assert!(
        message.contains("epochs") && message.contains("is damaged"),
        "{message}"
    );
    assert!(!run_directory.is_trained());
    std::fs::write(&best, &whole).unwrap();
    let _ = run(&format!("train --data mine --out run {SMALL}")).succeeds();
    assert_eq!(std::fs::read(run_directory.model()).unwrap(), whole);
}

#[test]
fn a_recording_can_be_left_out_and_the_run_goes_on_where_it_stopped() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    recordings(folder);
    let run = |command_line: &str| program::run(folder, command_line);
    let train = format!("train --data mine --convention own --fold yard --patience 1 {SMALL}");
    let told = run(&format!("{train} --out run")).succeeds();
    assert!(
        told.contains("next: ddl evaluate --model run --data mine\n"),
        "{told}"
    );
    // Stopped after the goals, then finished by the same command: the same bytes.
    for half in ["--only-goals", ""] {
        let _ = run(&format!("{train} --out halves {half}")).succeeds();
    }
    let weights = |run: &str| std::fs::read(folder.join(run).join("model.safetensors")).unwrap();
    assert_eq!(weights("run"), weights("halves"));

    let told = run("evaluate --model run --data mine --protocol fair --threads 1").succeeds();
    assert!(told.contains("yard") && !told.contains("lobby"), "{told}");
}

/// Where a folder holds none of the ETH/UCY recordings, a fold is one of its own.
#[test]
fn a_fold_of_own_recordings_needs_no_convention() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    recordings(folder);
    let run = |command_line: &str| program::run(folder, command_line);
    let of = "--data mine --fold yard";
    let windows = run(&format!("windows {of}")).succeeds();
    assert!(windows.lines().count() > 100);
    assert!(!windows.contains("lobby"));
    let measure = "--test-walkers 40 --protocol single --threads 1";
    let told = run(&format!("evaluate {of} {measure}")).succeeds();
    assert!(told.contains("\nyard "), "{told}");
    let same = run(&format!("evaluate --data mine/yard.csv {measure}")).succeeds();
    assert_eq!(told, same);
}

#[test]
fn mistakes_with_own_recordings_say_what_to_do() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    recordings(folder);
    std::fs::create_dir(folder.join("empty")).unwrap();
    // A folder that holds a recording of ETH/UCY.
    std::fs::create_dir(folder.join("star")).unwrap();
    std::fs::write(folder.join("star/zara01.csv"), "").unwrap();
    let short = own_tracks::three_people(12);
    std::fs::write(folder.join("short.csv"), own_tracks::csv(&short)).unwrap();
    for (command_line, words) in [
        ("train --out run", "your own recordings (--data FOLDER)"),
        (
            "train --data mine --out run --last-epoch-only",
            "--patience 0",
        ),
        (
            "baselines --convention own --data mine --fold none",
            "it has lobby, yard",
        ),
        ("train --data empty --out run", "holds no recordings"),
        ("train --data nowhere --out run", "cannot read nowhere"),
        ("train --data short.csv --out run", "no training windows"),
        (
            "train --data mine --convention own --fold attic --out run",
            "it has lobby, yard",
        ),
        (
            "train --data mine --fold lobby --out run",
            "add --convention own",
        ),
        (
            "train --data mine --out run --validation 0 --patience 3",
            "patience of 3 epochs",
        ),
        (
            "train --convention simulated --fold plaza --fps 25 --out run",
            "your own recordings",
        ),
        (
            "train --data mine --validation-recordings nope --out run",
            "\"nope\" is not one of these recordings: lobby, yard",
        ),
        ("evaluate --model hotel --convention own", "--data FOLDER"),
        ("evaluate --data mine --fold attic", "it has lobby, yard"),
        ("windows --data mine --fold attic", "it has lobby, yard"),
        ("evaluate --data star --fold attic", "add --convention own"),
        ("windows --data star --fold attic", "add --convention own"),
        (
            "evaluate --data mine --window-rule complete",
            "leave --window-rule out",
        ),
        ("forecast short.csv --region 0.5,0.50", "0.5 twice"),
        (
            "evaluate --model hotel --convention own --data short.csv",
            "20 steps in a row",
        ),
    ] {
        let message = program::run(folder, command_line).fails();
        assert!(message.contains(words), "{command_line}: {message}");
        assert!(
            !folder.join("run").exists(),
            "{command_line} left a run behind"
        );
    }
}

#[test]
fn recordings_in_pixels_or_of_a_camera_are_doubted_aloud() {
    let place = tempfile::tempdir().unwrap();
    for (factor, words) in [
        (60.0, "half of the steps are faster"),
        (0.1, "nine in ten steps"),
    ] {
        let mut rows = own_tracks::three_people(60);
        for (.., x, y) in &mut rows {
            (*x, *y) = (factor * *x, factor * *y);
        }
        std::fs::write(place.path().join("hall.csv"), own_tracks::csv(&rows)).unwrap();
        for command_line in [
            "evaluate --model hotel --convention own --data hall.csv --test-walkers 1 --protocol single --threads 1",
            "forecast hall.csv --last --one --threads 1",
        ] {
            let finished = program::run(place.path(), command_line);
            assert!(finished.stderr.contains(words), "{finished:#?}");
        }
    }
}
