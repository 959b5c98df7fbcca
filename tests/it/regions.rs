//! Adaptive regions: of the program on a real recording, and frame by frame.

use ddl::data::{Convention, Dataset, LiveTracks, PedestrianId, Recording};
use ddl::{AdaptiveRegions, DdlError, Forecaster as _, LiveForecaster, Variant};
use ddl_tests::own_tracks::{self, Row};
use ddl_tests::place::{Place, json_lines};
use ddl_tests::{bits, drawn_model, recordings};
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

fn rows(recording: &Recording, frames: usize) -> Vec<Row> {
    let end = recording.frames()[frames];
    let seen = recording.observations().iter();
    seen.filter(|seen| seen.frame < end)
        .map(|seen| {
            let [x, y] = seen.position;
            (seen.frame, seen.pedestrian.0, x, y)
        })
        .collect()
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
    let (rows_of_all, rows_of_half) = (rows(recording, FRAMES), rows(recording, FRAMES / 2));
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

#[test]
fn a_live_forecaster_adapts_and_an_error_changes_nothing() {
    let model = drawn_model::of(Variant::Full);
    let rows = own_tracks::three_pedestrians(30);
    let step = own_tracks::FRAME_STEP;
    let frames = own_tracks::frames(&rows);
    let pedestrians = |frame: i64| frames[&frame].clone();
    let live = LiveForecaster::with_tracks(&model, LiveTracks::with_frame_step(step).unwrap());
    let mut plain = live.clone();
    let mut adapting = live.with_adaptive_regions(AdaptiveRegions::default());
    let mut certified = adapting.clone();
    let mut expected = AdaptiveRegions::default();
    for frame in (0..30).map(|frame| frame * step) {
        if frame >= 8 * step {
            let before = adapting.regions().unwrap().table().cloned();
            let error = adapting.push(frame - step, pedestrians(frame)).unwrap_err();
            assert!(matches!(error, DdlError::Live(_)), "{error}");
            assert_eq!(adapting.regions().unwrap().table().cloned(), before);
        }
        let now = adapting.push(frame, pedestrians(frame)).unwrap();
        let evidence = certified.push_certified(frame, pedestrians(frame)).unwrap();
        let fixed = plain.push(frame, pedestrians(frame)).unwrap();
        let (Some(now), Some(evidence), Some(fixed)) = (now, evidence, fixed) else {
            assert!(frame < 7 * step);
            continue;
        };
        for (i, k) in (0..3).flat_map(|i| (0..now.forecast.hypotheses()).map(move |k| (i, k))) {
            assert_eq!(now.forecast.hypothesis(i, k), fixed.forecast.hypothesis(i, k));
        }
        // No forecast has ended yet.
        if frame < 19 * step {
            assert_eq!(bits::of(&now.forecast), bits::of(&fixed.forecast));
        }
        assert_eq!(evidence.forecast.forecast, now.forecast);
        let forecast = model.forecast(&now.window).unwrap();
        assert_eq!(now.forecast, expected.adapt(&now.window, forecast));
        assert_eq!(
            now.forecast == fixed.forecast,
            frame == 7 * step,
            "only the first forecast has unadapted regions"
        );
    }
    // The adaptation is kept when the tracker restarts.
    let learned = adapting.regions().unwrap().table().cloned();
    adapting.clear();
    assert_eq!(adapting.regions().unwrap().table().cloned(), learned);
    assert!(adapting.push(0, pedestrians(0)).unwrap().is_none());
}
