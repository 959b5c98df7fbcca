//! Recordings as other programs write them: words for pedestrians, rates in scenes of TrajNet++, pixels; and what is told of many.

use ddl::{RunConfig, Variant};
use ddl_tests::own_tracks::{self, Row};
use ddl_tests::{program, tiny_model};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::Stdio;

const WORDS: [&str; 3] = ["7f3e-aa41", "007", "b, \"the guard\""];

fn json_lines(text: &str) -> Vec<Value> {
    let line = |line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"));
    text.lines().map(line).collect()
}

/// The rows with a word for each pedestrian, in csv.
fn in_words(rows: &[Row]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer
        .write_record(["frame", "pedestrian", "x", "y"])
        .unwrap();
    for (frame, pedestrian, x, y) in rows {
        let word = WORDS[usize::try_from(*pedestrian).unwrap() - 1];
        let row = [
            frame.to_string(),
            word.to_owned(),
            x.to_string(),
            y.to_string(),
        ];
        writer.write_record(row).unwrap();
    }
    String::from_utf8(writer.into_inner().unwrap()).unwrap()
}

fn ndjson(rows: &[Row]) -> String {
    let line = |(f, p, x, y): &Row| {
        format!("{{\"track\": {{\"f\": {f}, \"p\": {p}, \"x\": {x}, \"y\": {y}}}}}\n")
    };
    rows.iter().map(line).collect()
}

/// Whoever is named by a word is forecast as who is numbered, and comes back under that word.
#[test]
fn words_come_back_as_they_were_written() {
    let folder = tiny_model::folder(Variant::Full);
    let folder = folder.path();
    let rows = own_tracks::three_people(10);
    std::fs::write(folder.join("words.csv"), in_words(&rows)).unwrap();
    let run = |options: &str| {
        program::run(folder, &format!("{options} --model . --threads 1")).succeeds()
    };
    let ask = |format: &str| run(&format!("forecast words.csv --whole {format}"));
    let numbered = program::forecast(folder, &rows, "--format jsonl").succeeds();

    let lines = json_lines(&ask("--format jsonl --certificate"));
    assert_eq!(lines.len(), 9);
    for (line, numbered) in lines.iter().zip(json_lines(&numbered)) {
        let number = numbered["pedestrian"].as_u64().unwrap();
        assert_eq!(
            line["pedestrian"],
            WORDS[usize::try_from(number).unwrap() - 1]
        );
        assert_eq!(line["observed_until"], numbered["observed_until"]);
        let positions = |of: &Value| of["hypotheses"][0]["positions"].clone();
        assert_eq!(positions(line), positions(&numbered));
    }
    for table in [ask(""), run("goals words.csv --whole")] {
        let mut reader = csv::Reader::from_reader(table.as_bytes());
        let column = reader
            .headers()
            .unwrap()
            .iter()
            .position(|name| name == "pedestrian");
        let column = column.unwrap();
        let found: BTreeSet<String> = reader
            .records()
            .map(|record| record.unwrap()[column].to_owned())
            .collect();
        assert_eq!(found, WORDS.map(str::to_owned).into());
    }
    let _ = run("view words.csv --no-open -o page.html");
    let page = std::fs::read_to_string(folder.join("page.html")).unwrap();
    assert!(page.contains("\"pedestrian\":\"b, \\\"the guard\\\"\""));

    let mut live = program::command(
        folder,
        "forecast - --model . --threads 1 --whole --frame-step 10 --format jsonl",
    )
    .stdin(Stdio::piped())
    .stdout(Stdio::piped())
    .spawn()
    .unwrap();
    let mut input = live.stdin.take().unwrap();
    input.write_all(in_words(&rows).as_bytes()).unwrap();
    drop(input);
    let told = String::from_utf8(live.wait_with_output().unwrap().stdout).unwrap();
    let found: Vec<Value> = json_lines(&told)
        .iter()
        .map(|line| line["pedestrian"].clone())
        .collect();
    assert_eq!(found, [WORDS, WORDS, WORDS].concat());
    words_are_named_where_something_is_wrong(folder, &rows);
}

fn words_are_named_where_something_is_wrong(folder: &Path, rows: &[Row]) {
    let twice = in_words(rows) + "90,7f3e-aa41,0,0\n";
    std::fs::write(folder.join("twice.csv"), twice).unwrap();
    let message = program::run(folder, "forecast twice.csv --model .").fails();
    assert!(
        message.contains("pedestrian 7f3e-aa41 is in frame 90 already"),
        "{message}"
    );
}

/// Another program forecasts recordings with words, and is scored.
#[test]
fn windows_of_words_are_forecast_by_another_program() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let rows = own_tracks::three_people(24);
    std::fs::write(folder.join("yard.csv"), in_words(&rows)).unwrap();
    let of = "--convention own --data yard.csv --fold yard";
    let windows = program::run(folder, &format!("windows {of}")).succeeds();
    let mut forecasts = String::new();
    let mut table = "observed_until,pedestrian,frame,x,y\n".to_owned();
    for line in json_lines(&windows) {
        let last = &line["observed"][7];
        let until = line["observed_until"].as_i64().unwrap();
        let word = line["pedestrian"].as_str().unwrap();
        for t in 1..=12 {
            let word = word.replace('"', "\"\"");
            let (frame, [x, y]) = (until + 10 * t, [&last[0], &last[1]]);
            writeln!(table, "{until},\"{word}\",{frame},{x},{y}").unwrap();
        }
        let still = serde_json::json!({
            "recording": line["recording"], "observed_until": until, "pedestrian": word,
            "hypotheses": [{"positions": vec![last; 12]}],
        });
        forecasts += &(still.to_string() + "\n");
    }
    std::fs::write(folder.join("still.jsonl"), forecasts).unwrap();
    std::fs::write(folder.join("still.csv"), table).unwrap();
    let scores = ["still.jsonl", "still.csv"].map(|file| {
        let scored = program::run(
            folder,
            &format!("evaluate --forecasts {file} {of} --name still"),
        );
        scored.succeeds()
    });
    assert!(scores[0].contains("pedestrian-windows"), "{}", scores[0]);
    assert_eq!(scores[0], scores[1]);
}

/// A step of 0.4 s is taken by the scenes' rate, unless another is given, and that is said.
#[test]
fn the_rate_of_scenes_is_used() {
    let folder = tiny_model::folder(Variant::Full);
    let folder = folder.path();
    let write = |name: &str, fps: &str| {
        let rows = own_tracks::three_people(40);
        let scene = format!(
            "{{\"scene\": {{\"id\": 0, \"p\": 1, \"s\": 0, \"e\": 200, \"fps\": {fps}}}}}\n"
        );
        std::fs::write(folder.join(name), scene + &ndjson(&rows)).unwrap();
    };
    write("two.ndjson", "2");
    write("usual.ndjson", "2.5");
    std::fs::write(
        folder.join("plain.ndjson"),
        ndjson(&own_tracks::three_people(40)),
    )
    .unwrap();
    let ask = |line: &str| {
        program::run(
            folder,
            &format!("forecast --model . --threads 1 --last {line}"),
        )
    };

    let two = ask("two.ndjson");
    let told = "note: the file's scenes give 2 frames a second, and its frame numbers rise by 10: read as --fps 20\n";
    assert!(two.stderr.contains(told), "{two:?}");
    assert_eq!(two.stdout, ask("plain.ndjson --fps 20").succeeds());

    let usual = ask("usual.ndjson");
    assert_eq!(usual.stderr, "");
    assert_eq!(usual.stdout, ask("plain.ndjson").succeeds());

    let other = ask("two.ndjson --fps 25");
    let told = "note: read as --fps 25, although the file's scenes give 2 frames a second";
    assert!(other.stderr.contains(told), "{other:?}");
    assert_eq!(other.stdout, ask("plain.ndjson --fps 25").succeeds());
    let same = ask("two.ndjson --fps 20");
    assert!(!same.stderr.contains("scenes"), "{same:?}");

    // line by line as well, where it makes whole frames
    for (file, code, told) in [
        (
            "usual.ndjson",
            0,
            "10 apart in 0.4 s, by the fps of the scenes, 2.5",
        ),
        (
            "two.ndjson",
            0,
            "8 apart in 0.4 s, by the fps of the scenes, 2",
        ),
    ] {
        let lines = std::fs::File::open(folder.join(file)).unwrap();
        let live = program::command(folder, "forecast - --model . --threads 1 --one")
            .stdin(lines)
            .output()
            .unwrap();
        let stderr = String::from_utf8(live.stderr).unwrap();
        assert_eq!(live.status.code(), Some(code), "{stderr}");
        assert!(stderr.contains(told), "{stderr}");
    }
}

/// Options say what numbers mean, then the file, then the run.
#[test]
fn the_rate_of_a_run_yields_to_files_and_options() {
    let folder = tiny_model::folder(Variant::Full);
    let folder = folder.path();
    let file = folder.join("config.json");
    let mut config: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    config["units"] = serde_json::json!({"fps": 50.0});
    std::fs::write(&file, config.to_string()).unwrap();
    let rows = own_tracks::three_people(40);
    let scene = "{\"scene\": {\"id\": 0, \"p\": 1, \"s\": 0, \"e\": 200, \"fps\": 2}}\n";
    std::fs::write(folder.join("two.ndjson"), scene.to_owned() + &ndjson(&rows)).unwrap();
    std::fs::write(folder.join("plain.csv"), own_tracks::csv(&rows)).unwrap();
    let note = "note: the numbers are read as in the run's training (--fps 50); give --fps, --dt, --frame-step or --homography to read them differently\n";
    let run = |line: &str| program::run(folder, &format!("{line} --model . --threads 1"));
    for command in ["forecast", "goals", "view --no-open -o page.html"] {
        let told = run(&format!("{command} plain.csv --last"));
        assert!(told.stderr.contains(note), "{told:?}");
        let page = std::fs::read(folder.join("page.html")).ok();
        let same = run(&format!("{command} plain.csv --last --fps 50"));
        assert!(!same.stderr.contains("training"), "{same:?}");
        assert_eq!(told.succeeds(), same.succeeds());
        assert_eq!(page, std::fs::read(folder.join("page.html")).ok());
        let of_file = run(&format!("{command} two.ndjson --last"));
        assert!(
            of_file.stderr.contains(": read as --fps 20\n"),
            "{of_file:?}"
        );
        assert!(!of_file.stderr.contains("training"), "{of_file:?}");
    }
    let two = run("forecast two.ndjson --last").succeeds();
    assert_eq!(two, run("forecast plain.csv --last --fps 20").succeeds());

    for (file, options, told) in [
        (
            "plain.csv",
            "",
            "20 apart in 0.4 s, as in the run's training (--fps 50)",
        ),
        (
            "two.ndjson",
            "",
            "8 apart in 0.4 s, by the fps of the scenes, 2",
        ),
        ("plain.csv", "--fps 25", ""),
    ] {
        let lines = std::fs::File::open(folder.join(file)).unwrap();
        let line = format!("forecast - --model . --threads 1 --one {options}");
        let live = program::command(folder, &line)
            .stdin(lines)
            .output()
            .unwrap();
        let stderr = String::from_utf8(live.stderr).unwrap();
        assert_eq!(live.status.code(), Some(0), "{stderr}");
        assert_eq!(stderr.contains("apart"), !told.is_empty(), "{stderr}");
        assert!(stderr.contains(told), "{stderr}");
    }
}

/// Three recordings in pixels, 23.98 frames a second, and their homography.
fn film(folder: &Path) {
    std::fs::create_dir(folder.join("film")).unwrap();
    let crowds = ddl_tests::crowd::dataset();
    for (name, scene) in [
        ("hall", "corridor"),
        ("lobby", "plaza"),
        ("yard", "crossing"),
    ] {
        let recording = crowds.recording(scene).unwrap();
        // a frame of the crowd is 0.04 s, one of the film 1 / 23.98 s: nearly
        let seen = recording
            .observations()
            .iter()
            .filter(|seen| seen.frame < 900);
        let rows: Vec<Row> = seen
            .map(|seen| {
                let [x, y] = seen.position;
                (seen.frame, seen.pedestrian.0, 50.0 * x, 50.0 * y)
            })
            .collect();
        std::fs::write(
            folder.join(format!("film/{name}.csv")),
            own_tracks::csv(&rows),
        )
        .unwrap();
    }
    // beside the recordings, and none of them
    std::fs::write(folder.join("film/H.txt"), "0.02 0 0\n0 0.02 0\n0 0 1\n").unwrap();
}

/// Cameras of 23.98 frames a second that count pixels: said once, remembered with the run.
#[test]
fn a_run_remembers_rate_and_homography() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    film(folder);
    let run = |line: &str| program::run(folder, line);
    let units = "--fps 23.98 --homography film/H.txt";

    let told = run(&format!("data film {units}"));
    let note = "note: 3 recordings: 0.4 s are 9.592 frames: positions are taken";
    assert_eq!(told.stderr.matches("9.592").count(), 1, "{told:?}");
    assert!(told.stderr.contains(note), "{told:?}");
    let text = told.succeeds();
    let total = text.lines().last().unwrap();
    assert!(total.starts_with("in all: 3 recordings, "), "{text}");
    assert!(
        total.contains(" pedestrians, ") && total.ends_with(" hours"),
        "{text}"
    );

    let train =
        "--epochs 1 --train-walkers 32 --batch-walkers 16 --proposal-steps 5 --threads 1 --out run";
    let _ = run(&format!(
        "train --data film --validation 0.3 {units} {train}"
    ))
    .succeeds();
    let config = std::fs::read_to_string(folder.join("run/config.json")).unwrap();
    let kept: RunConfig = serde_json::from_str(&config).unwrap();
    let kept = kept.units.unwrap();
    assert_eq!(
        (kept.fps, kept.dt, kept.frame_step),
        (Some(23.98), None, None)
    );
    assert!(kept.homography.is_some());
    let measure = "evaluate --model run --data film --validation --protocol single --threads 1";
    let measured = run(measure);
    let told = "the numbers are read as in the run's training (--fps 23.98 and its homography); give --fps, --dt, --frame-step or --homography to read \
                them differently";
    let note = format!("note: 3 recordings: {told}\n");
    assert!(measured.stderr.contains(&note), "{measured:?}");
    let _ = measured.succeeds();
    // so are tracks that it forecasts
    let forecast = "forecast film/hall.csv --model run --last --threads 1";
    let remembered = run(forecast);
    let note = format!("note: {told}\n");
    assert!(remembered.stderr.contains(&note), "{remembered:?}");
    let said = run(&format!("{forecast} {units}"));
    assert!(!said.stderr.contains("training"), "{said:?}");
    assert_eq!(remembered.succeeds(), said.succeeds());
    let live = program::command(folder, "forecast - --model run --threads 1")
        .stdin(std::fs::File::open(folder.join("film/hall.csv")).unwrap())
        .output()
        .unwrap();
    let refused = String::from_utf8(live.stderr).unwrap();
    let message = "error: the run was trained with --fps 23.98: 0.4 s are 9.592 frames";
    assert!(refused.contains(message), "{refused}");
    other_recordings_are_in_metres(folder);
    std::fs::remove_file(folder.join("film/H.txt")).unwrap();
    let _ = run(&format!("{measure} --protocol fair")).succeeds();
    // with another rate these are other recordings than those it was trained on
    let refused = run(&format!("{measure} --fps 25"));
    assert_eq!(refused.code, Some(1), "{refused:?}");
    let message = refused.stderr;
    assert!(message.contains("trained on other recordings"), "{message}");
}

/// What the run of [`a_run_remembers_rate_and_homography`] remembers does not hold for a file that gives its rate, nor for metres.
fn other_recordings_are_in_metres(folder: &Path) {
    let scene = "{\"scene\": {\"id\": 0, \"p\": 1, \"s\": 0, \"e\": 200, \"fps\": 2}}\n";
    let rows = own_tracks::three_people(40);
    std::fs::write(folder.join("two.ndjson"), scene.to_owned() + &ndjson(&rows)).unwrap();
    let measure = "evaluate --model run --data two.ndjson --protocol single --threads 1";
    let measure = format!("{measure} --homography none");
    let of_file = program::run(folder, &measure);
    assert!(
        of_file.stderr.contains(": read as --fps 20\n"),
        "{of_file:?}"
    );
    assert!(!of_file.stderr.contains("training"), "{of_file:?}");
    let said = program::run(folder, &format!("{measure} --fps 20"));
    assert_eq!(of_file.succeeds(), said.succeeds());
}

/// Tables have positions to 0.1 mm.
#[test]
fn tables_have_four_decimals() {
    let folder = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(8);
    let table = program::forecast(folder.path(), &rows, "").succeeds();
    let goals = program::run(folder.path(), "goals tracks.csv --model . --whole").succeeds();
    for (text, names) in [
        (table, &["goal_x", "goal_y", "x", "y"][..]),
        (goals, &["x", "y"]),
    ] {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().unwrap().clone();
        let mut longest = 0;
        for record in reader.records() {
            let record = record.unwrap();
            for (name, cell) in header.iter().zip(&record) {
                if names.contains(&name) {
                    let (_, decimals) = cell.split_once('.').unwrap();
                    longest = longest.max(decimals.len());
                    assert_ne!(cell, "-0.0");
                }
            }
        }
        assert_eq!(longest, 4);
    }
}
