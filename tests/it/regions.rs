//! Adaptive regions of the program on a real recording.

use ddl::data::{Convention, PedestrianId, Recording};
use ddl_tests::own_tracks;
use ddl_tests::place::{Place, json_lines};
use ddl_tests::recordings;
use serde::Deserialize as _;
use serde_json::Value;

/// Number of frames of the recording that are forecast.
const FRAMES: usize = 600;

/// The discs of the region of a line, at each step.
fn discs(line: &Value) -> Vec<Vec<[f64; 3]>> {
    Vec::deserialize(&line["regions"][0]["discs"]).unwrap()
}

/// Share of the later positions that are inside the regions of a line, for lines from that frame on.
fn held(lines: &[Value], recording: &Recording, from: i64) -> f64 {
    let (mut inside, mut seen) = (0, 0);
    for line in lines.iter().filter(|line| line["observed_until"].as_i64() >= Some(from)) {
        assert_eq!(line["regions"][0]["probability"], 0.9);
        let id = line["pedestrian"].as_i64().map(PedestrianId);
        let frames = Vec::<i64>::deserialize(&line["frames"]).unwrap();
        for (frame, discs) in frames.into_iter().zip(discs(line)) {
            let mut here = recording.at(frame).iter();
            let Some(seen_there) = here.find(|seen| Some(seen.pedestrian) == id) else {
                continue;
            };
            let [x, y] = seen_there.position;
            seen += 1;
            inside += usize::from(discs.iter().any(|disc| (disc[0] - x).hypot(disc[1] - y) <= disc[2]));
        }
    }
    assert!(seen > 1000, "{seen} positions");
    f64::from(u32::try_from(inside).unwrap()) / f64::from(seen)
}

#[test]
fn the_regions_reach_their_probability_without_future_data() {
    let Some(dataset) = recordings::dataset(Convention::Star) else {
        return;
    };
    let recording = dataset.recording("hotel").unwrap();
    let place = Place::empty();
    let rows = |frames: usize| own_tracks::of_recording(recording, i64::MIN..recording.frames()[frames]);
    let (rows_of_all, rows_of_half) = (rows(FRAMES), rows(FRAMES / 2));
    place.write_tracks("all.csv", &rows_of_all);
    place.write_tracks("half.csv", &rows_of_half);
    let options = "--model hotel --whole --frame-step 10 --region 0.9 --format jsonl --threads 1";
    let whole = place.ok(&format!("forecast all.csv {options}"));
    let until_half = place.ok(&format!("forecast half.csv {options}"));
    assert!(!until_half.is_empty() && whole.starts_with(&until_half));
    let streamed = place.run_on(&own_tracks::csv(&rows_of_all), &format!("forecast - {options}"));
    assert!(streamed.succeeds() == whole, "a stream has other forecasts");
    let lines: Vec<Value> = json_lines(&whole);
    let share = held(&lines, recording, recording.frames()[FRAMES / 2]);
    assert!((0.87..0.95).contains(&share), "{share}");
    // With --last no earlier frame is forecast, so the regions do not adapt.
    let last: Vec<Value> = json_lines(&place.ok(&format!("forecast all.csv --last {options}")));
    let from_all = &lines[lines.len() - last.len()..];
    let radius = |line: &Value| discs(line)[11][0][2];
    let differs = |(fixed, adapted): (&Value, &Value)| (radius(fixed) - radius(adapted)).abs() > 1e-9;
    assert!(last.iter().zip(from_all).all(differs));
    let [paths, scenes]: [Vec<Value>; 2] = ["path", "scene"].map(|of| {
        let held: Vec<Value> = json_lines(&place.ok(&format!("forecast all.csv {options} --region-holds {of}")));
        assert!(held.iter().all(|line| line["regions"][0]["holds"] == of));
        held
    });
    assert!(lines.iter().zip(&paths).all(|(step, path)| radius(step) <= radius(path)));
    assert!(paths.iter().zip(&scenes).all(|(path, scene)| radius(path) <= radius(scene)));
    let csv = place.ok("forecast all.csv --model hotel --frame-step 10 --last --region 0.9 --region-holds scene");
    assert!(csv.lines().next().unwrap().ends_with(",scene_radius_0.9"));
}
