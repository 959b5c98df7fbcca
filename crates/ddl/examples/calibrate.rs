//! Fits the calibration constants on recordings of places that no model was trained on.
//!
//! `calibrate FOLDER=FPS ...` prints for each folder and each built-in model the log loss of the weights, AMD and
//! likelihood, and the coverage of regions that were calibrated on the other folders. It then writes the table of
//! regions of all folders to `crates/ddl/src/trust/calibration.json`.
//!
//! It uses every other file of a folder, or the first half of the windows of a single file. The rest is for the final
//! evaluation.

#![expect(clippy::print_stdout, reason = "a program that prints a table")]

use ddl::data::{HORIZON, Window};
use ddl::eval::{Scene, Scores};
use ddl::{BuiltinModel, Calibration, Ddl, DeviceChoice, Forecast, Forecaster as _, Protocol, RegionTable};
use places::{Part, Place};
use std::error::Error;
use std::path::Path;

mod places;

const LEVELS: [f64; 12] = [0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99];
/// About this many pedestrian-windows of a folder are forecast by each model.
const PEDESTRIANS: usize = 1500;
/// Windows forecast at a time.
const CHUNK: usize = 64;

type TrueScores = Vec<[f64; HORIZON]>;

fn main() -> Result<(), Box<dyn Error>> {
    let places: Vec<Place> = std::env::args()
        .skip(1)
        .map(|place| Place::read(&place, Part::Calibration, PEDESTRIANS))
        .collect::<Result<_, _>>()?;
    if places.is_empty() {
        return Err("usage: calibrate FOLDER=FPS ..., with recordings of places that no model was trained on".into());
    }
    ddl::prepare(DeviceChoice::Cpu, None)?;
    let mut scores: Vec<TrueScores> = places.iter().map(|_| TrueScores::new()).collect();
    println!(
        "{:12} {:7} {:>6} {:>7} {:>7} {:>7}",
        "place", "model", "n", "weights", "AMD", "NLL"
    );
    for model in BuiltinModel::ALL {
        let ddl = Ddl::builtin(model, DeviceChoice::Cpu)?;
        for (place, scores) in places.iter().zip(&mut scores) {
            let mut forecasts = Vec::new();
            for windows in place.windows.chunks(CHUNK) {
                forecasts.extend(ddl.forecast_all(&Protocol::Fair.visible(windows))?);
            }
            let all = Scores::evaluate(&place.windows, &forecasts)?;
            let number = |x: Option<f64>| x.unwrap_or(f64::NAN);
            println!(
                "{:12} {:7} {:6} {:7.3} {:7.3} {:7.3}",
                place.name,
                model.name(),
                all.pedestrians,
                number(all.weight_log_loss),
                number(all.amd),
                number(all.kde_nll)
            );
            scores.extend(true_scores(&place.windows, &forecasts)?);
        }
    }
    for (left_out, place) in places.iter().enumerate() {
        let others: Vec<&TrueScores> = scores
            .iter()
            .enumerate()
            .filter(|(at, _)| *at != left_out)
            .map(|(_, of)| of)
            .collect();
        if let Some(table) = RegionTable::of(&balanced(&others), &LEVELS) {
            let held = |level: f64| {
                let inside = |of: &[f64; HORIZON]| {
                    (0..HORIZON)
                        .filter(|&t| table.quantile(level, t).is_some_and(|q| of[t] <= q))
                        .count()
                };
                let all = scores[left_out].iter().map(inside).sum::<usize>();
                100.0 * all as f64 / (HORIZON * scores[left_out].len()) as f64
            };
            println!(
                "{}: regions of the other places hold {:.1} % (50 %) and {:.1} % (90 %)",
                place.name,
                held(0.5),
                held(0.9)
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

fn balanced(places: &[&TrueScores]) -> TrueScores {
    let least = places.iter().map(|scores| scores.len()).min().unwrap_or(0);
    let spread = |scores: &&TrueScores| {
        let count = scores.len();
        (0..least).map(|k| scores[k * count / least]).collect::<Vec<_>>()
    };
    places.iter().flat_map(spread).collect()
}

fn true_scores(windows: &[Window], forecasts: &[Forecast]) -> Result<TrueScores, Box<dyn Error>> {
    let mut all = TrueScores::new();
    for (window, forecast) in windows.iter().zip(forecasts) {
        let scene = Scene::new(window, forecast)?;
        for i in 0..window.len() {
            let mut scores = [0.0; HORIZON];
            for (t, (score, &at)) in scores.iter_mut().zip(scene.truth(i)).enumerate() {
                *score = forecast.region_score(i, t, at).ok_or("the forecast has no spread")?;
            }
            all.push(scores);
        }
    }
    Ok(all)
}
