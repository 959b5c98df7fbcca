//! Adaptive regions of the program on a real recording.

use ddl::data::{Convention, Dataset, PedestrianId, Recording};
use ddl_tests::own_tracks;
use ddl_tests::place::{Place, json_lines};
use ddl_tests::recordings;
use serde::Deserialize;

/// Number of frames of the recording that are forecast.
const FRAMES: usize = 600;

#[derive(Debug, Deserialize)]
struct Line {
    observed_until: i64,
    pedestrian: i64,
    frames: Vec<i64>,
    regions: Vec<Region>,
}

#[derive(Debug, Deserialize)]
struct Region {
    probability: f64,
    discs: Vec<Vec<[f64; 3]>>,
}

/// Share of the later positions that are inside the regions of a line, for lines from that frame on.
fn held(lines: &[Line], recording: &Recording, from: i64) -> f64 {
    let (mut inside, mut seen) = (0, 0);
    for line in lines.iter().filter(|line| line.observed_until >= from) {
        assert!((line.regions[0].probability - 0.9).abs() < 1e-9);
        for (frame, discs) in line.frames.iter().zip(&line.regions[0].discs) {
            let here = recording.at(*frame).iter();
            let id = PedestrianId(line.pedestrian);
            let Some(seen_there) = here.clone().find(|seen| seen.pedestrian == id) else {
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
    let Some(folder) = recordings::star_folder() else {
        return;
    };
    let dataset = Dataset::load(Convention::Star, &folder).unwrap();
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
    let lines: Vec<Line> = json_lines(&whole);
    let share = held(&lines, recording, recording.frames()[FRAMES / 2]);
    assert!((0.87..0.95).contains(&share), "{share}");
    // With --last no earlier frame is forecast, so the regions do not adapt.
    let last: Vec<Line> = json_lines(&place.ok(&format!("forecast all.csv --last {options}")));
    let from_all = &lines[lines.len() - last.len()..];
    let radius = |line: &Line| line.regions[0].discs[11][0][2];
    assert!(
        last.iter()
            .zip(from_all)
            .all(|(fixed, adapted)| (radius(fixed) - radius(adapted)).abs() > 1e-9)
    );
}
