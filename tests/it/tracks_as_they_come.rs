//! Imperfect tracks: begun late, with gaps, at other rates, in pixels, with words as pedestrians; and the messages
//! about them.

use ddl_tests::own_tracks::{self, Row, ndjson};
use ddl_tests::place::{Place, json_lines};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// A TrajNet++ scene that states the rate.
const SCENE: &str = "{\"scene\": {\"id\": 0, \"p\": 1, \"s\": 0, \"e\": 200, \"fps\": 2}}\n";
const WORDS: [&str; 3] = ["7f3e-aa41", "007", "b, \"the guard\""];

fn unseen(line: &Value) -> [i64; 3] {
    ["observed_until", "pedestrian", "unseen"].map(|name| line[name].as_i64().unwrap())
}

fn in_words(rows: &[Row]) -> String {
    let mut text = "frame,pedestrian,x,y\n".to_owned();
    for (frame, pedestrian, x, y) in rows {
        let word = WORDS[usize::try_from(*pedestrian).unwrap() - 1].replace('"', "\"\"");
        writeln!(text, "{frame},\"{word}\",{x},{y}").unwrap();
    }
    text
}

fn forecast(rows: &[Row], options: &str) -> (Vec<Value>, String) {
    let place = Place::empty();
    place.write_tracks("tracks.csv", rows);
    place.write("H.txt", "0.015625 0 -5\n0 -0.015625 3.75\n0 0 1\n");
    let line = "forecast tracks.csv --threads 1 --format jsonl";
    let finished = place.run(&format!("{line} {options}"));
    assert_eq!(finished.code, Some(0), "{finished:?}");
    (json_lines(&finished.stdout), finished.stderr)
}

#[test]
fn late_arrivals_and_holes_are_forecast_and_flagged() {
    let mut rows = own_tracks::three_pedestrians(10);
    // The second pedestrian arrives at frame 60; the third is not seen at 40 and 50.
    rows.retain(|&(frame, id, ..)| !(id == 2 && frame < 60 || id == 3 && [40, 50].contains(&frame)));
    let (lines, stderr) = forecast(&rows, "--certificate --last");
    let note = "of 3 forecasts 1 are of pedestrians tracked for less than 8 steps";
    assert!(stderr.contains(note), "{stderr}");
    let qualities: Vec<_> = lines.iter().map(unseen).collect();
    assert_eq!(qualities, [[90, 1, 0], [90, 2, 4], [90, 3, 0]]);
    for line in &lines {
        let mut hypotheses = line["hypotheses"].as_array().unwrap().iter();
        assert!(hypotheses.all(|hypothesis| hypothesis["certificate"]["holds"] == true));
    }
    let (lines, stderr) = forecast(&rows, "--last --whole");
    assert_eq!(lines.iter().map(unseen).collect::<Vec<_>>(), [[90, 1, 0], [90, 3, 0]]);
    assert!(!stderr.contains("of pedestrians"), "{stderr}");
    // Pedestrians that have just appeared are forecast too.
    rows.push((90, 4, 3.0, 1.0));
    let (lines, stderr) = forecast(&rows, "--last");
    assert_eq!(unseen(&lines[3]), [90, 4, 7]);
    assert!(
        stderr.contains("of 4 forecasts 2 are of pedestrians tracked for less than 8 steps (1 of them"),
        "{stderr}"
    );
}

#[test]
fn a_step_need_not_be_a_whole_number_of_frames() {
    let rows: Vec<Row> = (0..=72).map(|frame| (frame, 1, 0.05 * frame as f64, 1.0)).collect();
    let (lines, stderr) = forecast(&rows, "--fps 24 --last");
    assert_eq!((unseen(&lines[0]), stderr.as_str()), ([72, 1, 0], ""));
    let frames: Vec<f64> = serde_json::from_value(lines[0]["frames"].clone()).unwrap();
    assert!((frames[0] - 81.6).abs() < 1e-9 && (frames[11] - 187.2).abs() < 1e-9);
    assert_eq!(lines[0]["frames"][4], 120);
}

/// Pixels of a camera that looks straight down, 64 per metre, y downwards.
#[test]
fn pixels_are_converted() {
    let metres = own_tracks::three_pedestrians(8);
    let pixel = |&(f, i, x, y): &Row| (f, i, 64.0 * x + 320.0, 240.0 - 64.0 * y);
    let pixels: Vec<Row> = metres.iter().map(pixel).collect();
    let expected = forecast(&metres, "--whole").0;
    assert_eq!(forecast(&pixels, "--whole --homography H.txt").0, expected);
    let stderr = forecast(&pixels, "").1;
    assert!(stderr.contains("--homography"), "{stderr}");
}

#[test]
fn words_are_returned_as_written() {
    let place = Place::empty();
    let rows = own_tracks::three_pedestrians(10);
    let numbered = forecast(&rows, "--whole --certificate").0;
    place.write("words.csv", in_words(&rows));
    let ask = |line: &str| place.ok(&format!("{line} --threads 1"));
    let in_words = |mut line: Value| {
        let number = line["pedestrian"].as_u64().unwrap();
        line["pedestrian"] = WORDS[usize::try_from(number).unwrap() - 1].into();
        line
    };
    let expected: Vec<Value> = numbered.into_iter().map(in_words).collect();
    let options = "--whole --certificate --format jsonl";
    let whole = ask(&format!("forecast words.csv {options}"));
    assert_eq!(json_lines::<Value>(&whole), expected);
    let line = format!("forecast - --threads 1 --frame-step 10 {options}");
    let live = place.run_on(&place.text("words.csv"), &line).succeeds();
    assert_eq!(json_lines::<Value>(&live), expected);
    let table = ask("forecast words.csv --whole");
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let column = reader.headers().unwrap().iter().position(|name| name == "pedestrian");
    let word = |record: csv::Result<csv::StringRecord>| record.unwrap()[column.unwrap()].to_owned();
    let words: BTreeSet<String> = reader.records().map(word).collect();
    assert_eq!(words, WORDS.map(str::to_owned).into());
    let _ = ask("view words.csv --no-open -o page.html");
    let page = place.text("page.html");
    assert!(page.contains(r#""pedestrian":"b, \"the guard\"""#));
    place.write("twice.csv", place.text("words.csv") + "90,7f3e-aa41,0,0\n");
    place.fails("forecast twice.csv", &["pedestrian 7f3e-aa41 is in frame 90 already"]);
}

#[test]
fn a_late_row_is_told_and_a_given_rate_takes_precedence() {
    let place = Place::empty();
    let walk = own_tracks::csv(&own_tracks::three_pedestrians(10));
    place.write("late.csv", walk.clone() + "900,77,0,0\n");
    let _ = place
        .run("forecast late.csv --frame-step 10 --last --one --whole --threads 1")
        .says("there is no forecast for the last frame of the file (frame 900); the last one is at frame 90");
    place.write("fast.csv", "# fps: 1e12\n".to_owned() + &walk);
    let _ = place.ok("forecast fast.csv --frame-step 10 --last --one --threads 1");
    place.fails("forecast fast.csv --last", &["a frame must take more than 0 s"]);
}

/// Each on a clock of its own: at every moment one of them is carried on, under its name.
#[test]
fn carried_pedestrians_keep_their_words() {
    let place = Place::empty();
    let mut text = "time,pedestrian,x,y\n".to_owned();
    for t in 0..12 {
        let seconds = 0.4 * f64::from(t);
        writeln!(text, "{seconds:.2},anna,{t},0\n{:.2},bob,{t},2", seconds + 0.13).unwrap();
    }
    place.write("two.csv", &text);
    let options = "--one --threads 1 --every 0 --format jsonl";
    let file = place.ok(&format!("forecast two.csv {options}"));
    assert_eq!(place.run_on(&text, &format!("forecast - {options}")).succeeds(), file);
    let lines: Vec<Value> = json_lines(&file);
    let names: BTreeSet<&str> = lines.iter().filter_map(|line| line["pedestrian"].as_str()).collect();
    assert_eq!((names, lines.len()), (BTreeSet::from(["anna", "bob"]), 24 + 23));
    let _ = place.ok("view two.csv --no-open -o two.html");
    assert!(place.text("two.html").contains("\"when\":\"1.2 s\""));
}

#[test]
fn the_rate_of_scenes_is_used() {
    let place = Place::empty();
    let plain = ndjson(&own_tracks::three_pedestrians(40));
    place.write("plain.ndjson", &plain);
    place.write("two.ndjson", format!("{SCENE}{plain}"));
    place.write("usual.ndjson", format!("{}{plain}", SCENE.replace("2}}", "2.5}}")));
    let ask = |line: &str| place.run(&format!("forecast --threads 1 --last {line}"));
    for (line, note, same_as) in [
        (
            "two.ndjson",
            "note: the file gives 2 frames per second, and its frame numbers increase by 10: read as --fps \
             20\n",
            "plain.ndjson --fps 20",
        ),
        (
            "two.ndjson --fps 25",
            "note: read as --fps 25, although the file gives 2 frames per second, and its frame numbers \
             increase by 10 (--fps 20)\n",
            "plain.ndjson --fps 25",
        ),
        ("usual.ndjson", "", "plain.ndjson"),
        ("two.ndjson --fps 20", "", "plain.ndjson --fps 20"),
    ] {
        let finished = ask(line);
        let notes = finished.stderr.split_inclusive('\n');
        let of_rate: String = notes.filter(|note| note.contains("the file gives")).collect();
        assert_eq!(of_rate, note);
        assert_eq!(finished.succeeds(), ask(same_as).succeeds());
    }
}

#[test]
fn files_and_options_override_the_rate_of_a_run() {
    let place = Place::with_model();
    let mut config: Value = serde_json::from_str(&place.text("run/config.json")).unwrap();
    config["units"] = json!({"fps": 50.0});
    place.write("run/config.json", config.to_string());
    let rows = own_tracks::three_pedestrians(40);
    place.write("two.ndjson", SCENE.to_owned() + &ndjson(&rows));
    place.write_tracks("plain.csv", &rows);
    let note = "note: the units are those of the run's training (--fps 50); give --fps, --dt, --frame-step or \
                --homography if this is wrong\n";
    let run = |line: &str| place.run(&format!("{line} --model run --threads 1"));
    for command in ["forecast", "view --no-open -o page.html"] {
        let with_units_of_run = run(&format!("{command} plain.csv --last")).says(note);
        let page = std::fs::read(place.at("page.html")).ok();
        let same = run(&format!("{command} plain.csv --last --fps 50"));
        assert!(!same.stderr.contains("training"), "{same:?}");
        assert_eq!(with_units_of_run.succeeds(), same.succeeds());
        assert_eq!(page, std::fs::read(place.at("page.html")).ok());
        let of_file = run(&format!("{command} two.ndjson --last")).says(": read as --fps 20\n");
        assert!(!of_file.stderr.contains("training"), "{of_file:?}");
    }
    let two = run("forecast two.ndjson --last").succeeds();
    assert_eq!(two, run("forecast plain.csv --last --fps 20").succeeds());
    for (file, options, note) in [
        ("plain.csv", "", "a step of 0.4 s is taken as 20 frames, as in the run's training (--fps 50)"),
        ("two.ndjson", "", "taken as 8 frames, from the fps of the scenes, 2"),
        ("plain.csv", "--fps 25", ""),
    ] {
        let line = format!("forecast - --model run --threads 1 --one {options}");
        let live = place.run_on(&place.text(file), &line).says(note);
        assert_eq!(live.stderr.contains("is taken as"), !note.is_empty(), "{live:?}");
        live.succeeds();
    }
}

#[test]
fn a_page_shows_the_moments_of_own_tracks() {
    let place = Place::empty();
    place.write_tracks("lobby.csv", &own_tracks::three_pedestrians(15));
    let printed = place.ok("view lobby.csv --moments 5");
    assert_eq!(printed, "lobby-forecasts.html\n");
    let page = place.text("lobby-forecasts.html");
    // From the first frame on all pedestrians are forecast.
    assert!(page.contains("5 of 15 moments of lobby.csv"));
    assert!(page.contains("Certificates: 300 of 300 hypotheses"));
    let data = page.split("id=\"moments-json\">").nth(1).unwrap();
    let moments: Vec<Value> = ddl_tests::place::json(data.split("</script>").next().unwrap());
    let count = |moment: usize, name: &str| moments[moment]["pedestrians"][0][name].as_array().unwrap().len();
    assert_eq!(moments.len(), 5);
    assert_eq!(moments[4]["frame"], 14 * own_tracks::FRAME_STEP);
    assert_eq!(moments[4]["when"], "frame 140");
    assert_eq!((count(4, "truth"), count(4, "paths")), (0, 20));
    // The first of five is the third of fifteen: seen for 3 frames, with a known future.
    assert_eq!(moments[0]["pedestrians"][0]["quality"]["unseen"], 5);
    assert_eq!(count(0, "truth"), 24);
}

/// Four people who walk 4 m at 1 m/s, with ten rows a second.
fn walk_at_10_hz() -> String {
    let mut text = "frame,pedestrian,x,y\n".to_owned();
    for frame in 0..40 {
        for id in 0..4 {
            writeln!(text, "{frame},{id},{:.2},{id}", 0.1 * f64::from(frame)).unwrap();
        }
    }
    text
}

#[test]
fn streams_doubt_what_files_doubt() {
    let place = Place::empty();
    let walk = walk_at_10_hz();
    let narrow = walk.replace(",0.", ",0.00").replace(",1.", ",0.01");
    let too_fast = walk.replace('.', "");
    let cases = [
        (&walk, "nine in ten steps of walking pedestrians are slower than"),
        (&narrow, "no pedestrian moves farther|all 4 pedestrians are within|nine in ten"),
        (&too_fast, "half of the steps are faster"),
    ];
    for (tracks, doubts) in cases {
        place.write("tracks.csv", tracks);
        let of_file = place.run("forecast tracks.csv --frame-step 1 --one --threads 1").stderr;
        let of_stream = place.run_on(tracks, "forecast - --frame-step 1 --one --threads 1").stderr;
        let doubt = doubts.split('|').find(|doubt| of_file.contains(doubt)).unwrap();
        assert_eq!(of_stream.matches(doubt).count(), 1, "{of_file}\n{of_stream}");
    }
}

#[test]
fn a_stream_takes_the_rate_of_a_comment() {
    let place = Place::empty();
    let stated = format!("# framerate: 10 fps\n{}", walk_at_10_hz());
    let line = "forecast - --one --threads 1 --format jsonl";
    let of_comment = place.run_on(&stated, line);
    // The same rate in any words is not another one.
    for (option, is_other) in [("--fps 10", false), ("--dt 0.1", false), ("--frame-step 4", false), ("--fps 9", true)] {
        let of_option = place.run_on(&stated, &format!("{line} {option}"));
        assert_eq!(of_comment.stdout != of_option.stdout, is_other, "{option}");
        let told = of_option.stderr.contains("although the input says 10 frames a second");
        assert_eq!(told, is_other, "{}", of_option.stderr);
    }
    let stderr = of_comment.says("at 10 frames a second").stderr;
    assert!(!stderr.contains("slower"), "{stderr}");
}

/// Not one pedestrian called 0.
#[test]
fn ids_that_look_like_numbers_are_names_in_files_and_streams() {
    let ids = ["0e12", "0e34", "007", "12"];
    let row = |t: i32, i: usize| format!("{t},{},{},{}\n", ids[i], 0.5 * f64::from(t), 2 * i);
    let rows: String = (0..9).flat_map(|t| (0..4).map(move |i| row(t, i))).collect();
    let place = Place::empty();
    place.write("hex.csv", format!("frame,pedestrian,x,y\n{rows}"));
    let file = place.ok("forecast hex.csv --fps 2.5 --one --format jsonl");
    let stream = place.run_on(&format!("frame,pedestrian,x,y\n{rows}"), "forecast - --fps 2.5 --one --format jsonl");
    assert_eq!(stream.succeeds(), file);
    let named: BTreeSet<String> = json_lines(&file).iter().map(|line: &Value| line["pedestrian"].to_string()).collect();
    assert_eq!(named, ["\"0e12\"", "\"0e34\"", "\"007\"", "12"].map(str::to_owned).into());
}
