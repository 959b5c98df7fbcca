//! Logs of robots, `FILE.mcap`: the same three pedestrians as messages of four kinds, written by the packages `mcap`
//! and `rosbags` of Python. More of them: `crates/ddl-python/tests/test_mcap.py`.

use ddl_tests::place::Place;
use std::path::Path;

const LOGS: [&str; 4] = ["people_zstd", "detections_lz4", "persons_json", "lines_json"];

fn place() -> Place {
    let place = Place::with_model();
    for name in LOGS.map(|name| format!("{name}.mcap")) {
        let seed = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus/mcap").join(&name);
        place.write(&name, std::fs::read(seed).unwrap());
    }
    place
}

#[test]
fn every_kind_of_log_and_its_copy_give_the_same_forecasts() {
    let place = place();
    let forecast = |name: &str| place.ok(&format!("forecast --model run {name}.mcap --one"));
    let expected = forecast(LOGS[0]);
    assert_eq!(expected.lines().count(), 1 + 10 * 3 * 12);
    for name in LOGS {
        place.ok(&format!("forecast --model run {name}.mcap --one -o {name}-copy.mcap"));
        for log in [name.to_owned(), format!("{name}-copy")] {
            assert!(forecast(&log) == expected, "{log}");
        }
    }
}

#[test]
fn what_is_missing_is_told() {
    let place = place();
    for (line, code, words) in [
        ("forecast people_zstd.mcap --fps 10", 1, "--fps 10 gives a rate: leave it out"),
        ("forecast people_zstd.mcap --unit cm", 1, "leave out --columns and --unit"),
        ("data detections_lz4.mcap --keep class=car", 0, "; 30 rows left out: class person"),
        ("forecast tracks.csv --topic /people", 1, "only MCAP has topics"),
        ("forecast - -o out.mcap", 1, "not from standard input"),
        ("forecast tracks.csv --format csv -o out.mcap", 1, "leave out one of them"),
    ] {
        let finished = place.run(line);
        assert_eq!(finished.code, Some(code), "{finished:?}");
        assert!(finished.stderr.contains(words), "{finished:?}");
    }
}
