//! A user's own recordings: summary and evaluation with `ddl data`, `ddl evaluate --data`, `ddl windows --data`.

use ddl_tests::place::{Place, json};
use serde_json::Value;

#[test]
fn models_are_measured_on_own_recordings() {
    let place = Place::with_recordings();
    let windows = place.ok("windows --data mine --fold yard");
    assert!(windows.lines().count() > 100 && !windows.contains("lobby"));
    let measure = "--test-pedestrians 40 --protocol single --threads 1";
    let [of_fold, of_file, of_model] =
        ["--data mine --fold yard", "--data mine/yard.csv", "--model world --convention own --data mine/yard.csv"]
            .map(|subject| place.ok(&format!("evaluate {subject} {measure}")));
    assert!(of_fold.contains("convention own, protocol single"), "{of_fold}");
    assert!(of_fold.contains("\nyard "), "{of_fold}");
    assert_eq!(of_fold, of_file);
    assert_eq!(of_fold, of_model);
}

/// Windows of own recordings also hold pedestrians without a future, who have goals too.
#[test]
fn goals_have_the_same_error_in_both_commands() {
    let place = Place::with_recordings();
    let of_goals = place.json("goals --measure test --data mine/yard.csv --json --threads 1");
    let evaluated = place.json("evaluate --data mine/yard.csv --protocol fair --json --threads 1");
    let scores = &evaluated["rows"][0]["scores"];
    assert_eq!(of_goals["all"]["pedestrians"], scores["pedestrians"]);
    let [one, other] = [&of_goals["all"]["oracle_fde"], &scores["goal_fde"]].map(|fde| fde.as_f64().unwrap());
    assert!((one - other).abs() < 1e-9, "{one} {other}");
}

#[test]
fn unreadable_files_are_reported_together() {
    let place = Place::with_recordings();
    place.write("mine/roof.csv", "frame,pedestrian,x,y\n1,1,a,0\n");
    let finished = place.run("data mine");
    assert_eq!(finished.code, Some(1));
    for name in ["mine/lobby.csv", "mine/yard.csv"] {
        assert!(finished.stdout.contains(name), "{finished:?}");
    }
    assert!(finished.stderr.starts_with("error: mine/roof.csv"), "{finished:?}");

    for index in 0..11 {
        place.write(&format!("mine/empty{index}.txt"), "");
    }
    for line in ["data mine", "train --data mine --out run"] {
        let finished = place.run(line);
        assert_eq!(finished.code, Some(1));
        let lines: Vec<&str> = finished.stderr.lines().filter(|line| !line.starts_with("note: ")).collect();
        assert!(lines.iter().all(|line| line.starts_with("error: ")), "{finished:?}");
        assert!(lines[0].contains("mine/empty0.txt"), "{finished:?}");
        let last = "error: 12 of 14 files cannot be read; the first 10 are listed above";
        assert_eq!((lines.len(), lines[10]), (11, last));
    }
    assert!(!place.at("run").exists());
    let finished = place.run("data mine --json");
    let read = &json::<Value>(&finished.stdout)["total"]["recordings"];
    assert_eq!((finished.code, read), (Some(1), &2.into()));
}

#[test]
fn each_recording_of_a_folder_has_a_row() {
    let place = Place::empty();
    place.write_clips(300, 3);
    let words = place.ok("evaluate --data clips --protocol fair --threads 1 --out report");
    assert!(words.contains("3 recordings, clip0 to clip2"), "{words}");
    assert!(!words.contains("clip0+"), "{words}");
    let by_recording = words.split("\nrecording ").nth(1).unwrap();
    for clip in ["clip0", "clip1", "clip2"] {
        let lines = by_recording.lines().filter(|line| line.starts_with(clip));
        assert_eq!(lines.count(), 1, "{words}");
    }
    let page = place.text("report/report.md");
    assert!(page.contains("By recording") && page.contains("| clip2 "), "{page}");

    let measured = place.json("goals --measure test --data clips --json --progress none --threads 1");
    assert_eq!(measured["fold"], "3 recordings, clip0 to clip2");
    assert_eq!(measured["recordings"].as_object().unwrap().len(), 3);
    let of_part = place.ok("goals --measure validation --data clips --threads 1");
    assert!(of_part.contains("clip1") && !of_part.contains("clip2"), "{of_part}");
}
