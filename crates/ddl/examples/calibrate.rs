//! Fits the calibration constants on recordings of places that no model was trained on.
//!
//! `calibrate FOLDER=FPS ...` prints for each folder the coverage of regions that were calibrated on the other folders.
//! It then writes the table of regions of all folders to `crates/ddl/src/trust/calibration.json`.
//!
//! It uses every other file of a folder, or the first half of the windows of a single file. The rest is for the final
//! evaluation.

#![expect(clippy::print_stdout, reason = "a program that prints a table")]

use ddl::data::{HORIZON, Window, WindowRule};
use ddl::eval::ScoredWindow;
use ddl::{BuiltinModel, Calibration, Ddl, DeviceChoice, Forecast, Forecaster as _, Protocol, RegionTable};
use std::error::Error;
use std::path::Path;

mod places;

const LEVELS: [f64; 12] = [0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99];
/// About this many pedestrian-windows of a folder are forecast by each model.
const PEDESTRIANS: usize = 1500;
/// Windows forecast at a time.
const CHUNK: usize = 64;

type TrueScores = Vec<[f64; HORIZON]>;

/// The places in order of the arguments: name, and evenly spread windows for fitting.
struct Place {
    name: String,
    windows: Vec<Window>,
}

impl Place {
    /// Every other recording of `FOLDER=FPS`, or the first half of the windows of a single one.
    fn read(place: &str) -> Result<Self, Box<dyn Error>> {
        let recordings = places::recordings(place)?;
        let rule = WindowRule::Complete;
        let mut windows: Vec<Window> = recordings.iter().step_by(2).flat_map(|r| r.windows(rule)).collect();
        if recordings.len() == 1 {
            windows.truncate(windows.len() / 2);
        }
        let pedestrians: usize = windows.iter().map(Window::len).sum();
        let every = pedestrians.div_ceil(PEDESTRIANS).max(1);
        Ok(Self {
            name: place.to_owned(),
            windows: windows.into_iter().step_by(every).collect(),
        })
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let places = std::env::args().skip(1).map(|place| Place::read(&place));
    let places: Vec<Place> = places.collect::<Result<_, _>>()?;
    if places.is_empty() {
        return Err("usage: calibrate FOLDER=FPS ..., with recordings of places that no model was trained on".into());
    }
    ddl::prepare(DeviceChoice::Cpu, None)?;
    let mut scores: Vec<TrueScores> = places.iter().map(|_| TrueScores::new()).collect();
    for model in BuiltinModel::ALL {
        let ddl = Ddl::builtin(model, DeviceChoice::Cpu)?;
        for (place, scores) in places.iter().zip(&mut scores) {
            for windows in place.windows.chunks(CHUNK) {
                let forecasts = ddl.forecast_all(&Protocol::Fair.visible(windows))?;
                scores.extend(true_scores(windows, &forecasts)?);
            }
        }
    }
    for (left_out, place) in places.iter().enumerate() {
        let others = scores.iter().enumerate().filter(|(index, _)| *index != left_out);
        let others: Vec<&TrueScores> = others.map(|(_, scores)| scores).collect();
        if let Some(table) = RegionTable::of(&balanced(&others), &LEVELS) {
            let [half, most] = [0.5, 0.9].map(|level| held(&table, &scores[left_out], level));
            println!(
                "{}: regions of the other places hold {half:.1} % (50 %) and {most:.1} % (90 %)",
                place.name
            );
        }
    }
    let table = RegionTable::of(&balanced(&scores.iter().collect::<Vec<_>>()), &LEVELS).ok_or("no scores")?;
    let fitted = Calibration {
        regions: table,
        ..Calibration::fitted().clone()
    };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/trust/calibration.json");
    std::fs::write(&file, serde_json::to_string_pretty(&fitted)? + "\n")?;
    println!("{}", file.display());
    Ok(())
}

/// Percentage of the true positions that are inside the regions of this level.
fn held(table: &RegionTable, scores: &TrueScores, level: f64) -> f64 {
    let is_inside = |(t, score): (usize, &f64)| table.quantile(level, t).is_some_and(|q| *score <= q);
    let steps = scores.iter().map(|of_pedestrian| of_pedestrian.iter().enumerate());
    let inside: usize = steps.map(|steps| steps.filter(|step| is_inside(*step)).count()).sum();
    100.0 * inside as f64 / (HORIZON * scores.len()) as f64
}

fn balanced(places: &[&TrueScores]) -> TrueScores {
    let least = places.iter().map(|scores| scores.len()).min().unwrap_or(0);
    let spread = |scores: &&TrueScores| {
        let count = scores.len();
        (0..least).map(|k| scores[k * count / least]).collect::<Vec<_>>()
    };
    places.iter().flat_map(spread).collect()
}

fn true_scores(windows: &[Window], forecasts: &[Forecast]) -> Result<TrueScores, Box<dyn Error>> {
    let mut scores_of_all = TrueScores::new();
    for (window, forecast) in windows.iter().zip(forecasts) {
        let scene = ScoredWindow::new(window, forecast)?;
        for i in 0..window.len() {
            let mut scores = [0.0; HORIZON];
            for (t, (score, &position)) in scores.iter_mut().zip(scene.truth(i)).enumerate() {
                *score = forecast
                    .region_score(i, t, position)
                    .ok_or("the forecast has no spread")?;
            }
            scores_of_all.push(scores);
        }
    }
    Ok(scores_of_all)
}
