//! Compares rules by which one forecast is made of a model's hypotheses, on the windows that its training kept for validation:
//! `one_forecast RUN`. Mean ADE/FDE in metres of each recording, beside constant velocity: the rows of the table in docs/accuracy.md but
//! those of the central goal, which `ddl evaluate --validation` measures under `single`.

#![expect(clippy::print_stdout, reason = "a program that prints a table")]

use ddl::data::{Convention, Dataset, HORIZON, OBSERVED, Position, Window, locate};
use ddl::eval::baseline::ConstantVelocity;
use ddl::eval::metric::displacement::{average_displacement, final_displacement};
use ddl::eval::representative::medoid;
use ddl::{Ddl, DeviceChoice, Forecast, Forecaster as _, Protocol};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

/// Windows forecast at a time.
const CHUNK: usize = 64;
/// Powers that weights are raised to, before they are divided by their sum.
const POWERS: [f64; 5] = [0.5, 0.75, 1.0, 1.5, 2.0];
/// Steps of Weiszfeld's iteration for a geometric median.
const STEPS: usize = 50;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [run] = arguments.as_slice() else {
        return Err("usage: one_forecast RUN, of `ddl train --validation-recordings ...`".into());
    };
    ddl::prepare(DeviceChoice::Cpu, Some(1))?;
    let model = Ddl::load(Path::new(run), DeviceChoice::Cpu)?;
    let data = &model.config().data;
    let dataset = match data.convention {
        Convention::Simulated => Dataset::simulated(1),
        recorded => Dataset::load(recorded, &locate(recorded, None)?)?,
    };
    let fold = dataset
        .fold(&data.fold)?
        .set_apart(&data.validation_recordings)?;
    let windows = fold
        .training_split(data.window_rule, data.validation)
        .validation;
    let mut errors = Errors::default();
    for windows in windows.chunks(CHUNK) {
        let seen = Protocol::Fair.visible(windows);
        let forecasts = model.forecast_all(&seen)?;
        for velocity in [
            ConstantVelocity::last_step(),
            ConstantVelocity::mean_observed(),
        ] {
            for (window, forecast) in windows.iter().zip(velocity.forecast_all(&seen)?) {
                for i in 0..window.len() {
                    errors.add(velocity.name(), window, i, forecast.hypothesis(i, 0));
                }
            }
        }
        for (window, forecast) in windows.iter().zip(&forecasts) {
            for i in 0..window.len() {
                compare(&mut errors, window, forecast, i);
            }
        }
    }
    errors.print();
    Ok(())
}

/// Every rule on one walker.
fn compare(errors: &mut Errors, window: &Window, forecast: &Forecast, i: usize) {
    let path = |k: usize| forecast.hypothesis(i, k);
    let ade = |k: usize, j: usize| average_displacement(path(k), path(j));
    let fde = |k: usize, j: usize| final_displacement(path(k), path(j));
    let heaviest = forecast.most_likely(i);
    errors.add("greatest weight".to_owned(), window, i, path(heaviest));
    straight_line(errors, window, forecast, i);
    for power in POWERS {
        let weights = raised(forecast, i, power);
        let mut one = |rule: &str, path: &[Position]| {
            errors.add(format!("{rule}, w^{power}"), window, i, path);
        };
        one("medoid by paths", path(medoid(&weights, ade)));
        one("medoid by ends", path(medoid(&weights, fde)));
        let both = medoid(&weights, |k, j| ade(k, j) + fde(k, j));
        one("medoid by both", path(both));
        one("mean path", &frames(|t| mean(forecast, i, t, &weights)));
        one("median path", &frames(|t| median(forecast, i, t, &weights)));
    }
}

/// The medoid by paths of straight lines at constant speed to the same goals.
fn straight_line(errors: &mut Errors, window: &Window, forecast: &Forecast, i: usize) {
    let start = window.observed(i)[OBSERVED - 1];
    let goals: Option<Vec<Position>> = (0..forecast.hypotheses())
        .map(|k| forecast.goal(i, k))
        .collect();
    let Some(goals) = goals else { return };
    let line = |k: usize| {
        frames(|t| {
            let share = (t + 1) as f64 / HORIZON as f64;
            [0, 1].map(|axis| start[axis] + share * (goals[k][axis] - start[axis]))
        })
    };
    let lines: Vec<Vec<Position>> = (0..goals.len()).map(line).collect();
    let weights = raised(forecast, i, 1.0);
    let one = medoid(&weights, |k, j| average_displacement(&lines[k], &lines[j]));
    let rule = "straight lines, medoid by paths, w^1".to_owned();
    errors.add(rule, window, i, &lines[one]);
}

fn raised(forecast: &Forecast, i: usize, power: f64) -> Vec<f64> {
    let powers = (0..forecast.hypotheses()).map(|k| forecast.weight(i, k).powf(power));
    let powers: Vec<f64> = powers.collect();
    let sum: f64 = powers.iter().sum();
    powers.iter().map(|power| power / sum).collect()
}

fn frames(place: impl Fn(usize) -> Position) -> Vec<Position> {
    (0..HORIZON).map(place).collect()
}

/// The weighted mean of the places of one frame: of least expected squared distance.
fn mean(forecast: &Forecast, i: usize, t: usize, weights: &[f64]) -> Position {
    let mut sum = [0.0; 2];
    for (k, weight) in weights.iter().enumerate() {
        let [x, y] = forecast.hypothesis(i, k)[t];
        sum = [sum[0] + weight * x, sum[1] + weight * y];
    }
    sum
}

/// Their geometric median: of least expected distance, though on nobody's path.
fn median(forecast: &Forecast, i: usize, t: usize, weights: &[f64]) -> Position {
    let mut here = mean(forecast, i, t, weights);
    for _ in 0..STEPS {
        let pulls: Vec<f64> = (0..weights.len())
            .map(|k| {
                let [x, y] = forecast.hypothesis(i, k)[t];
                weights[k] / (x - here[0]).hypot(y - here[1]).max(1e-6)
            })
            .collect();
        let sum: f64 = pulls.iter().sum();
        let pulls: Vec<f64> = pulls.iter().map(|pull| pull / sum).collect();
        here = mean(forecast, i, t, &pulls);
    }
    here
}

/// Sums of ADE and FDE with the number of walkers, by rule and recording.
#[derive(Default)]
struct Errors(BTreeMap<String, BTreeMap<String, (f64, f64, usize)>>);

impl Errors {
    fn add(&mut self, rule: String, window: &Window, i: usize, path: &[Position]) {
        let truth = window.future(i);
        let (ade, fde) = (
            average_displacement(path, truth),
            final_displacement(path, truth),
        );
        let of_rule = self.0.entry(rule).or_default();
        for recording in [window.recording(), "all"] {
            let sum = of_rule.entry(recording.to_owned()).or_default();
            *sum = (sum.0 + ade, sum.1 + fde, sum.2 + 1);
        }
    }

    fn print(&self) {
        for (rule, recordings) in &self.0 {
            let cells: Vec<String> = recordings
                .iter()
                .map(|(recording, &(ade, fde, walkers))| {
                    let count = walkers as f64;
                    format!(
                        "{recording} ({walkers}) {:.3}/{:.3}",
                        ade / count,
                        fde / count
                    )
                })
                .collect();
            println!("{rule}: {}", cells.join(", "));
        }
    }
}
