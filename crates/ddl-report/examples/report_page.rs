//! Writes the report page of simulated crowds: `report_page FOLDER` makes `page.html`, `figures/*.svg` and their data
//! (`report.json`, `moments.json`), and `viewer.html`, a page with only the player, with pedestrians that leave the
//! view.
//!
//! The forecaster is a stand-in with 20 weighted goals, and the training curves are invented; the page names both as
//! such.

use std::{error::Error, f64::consts::TAU, path::Path};

use ddl_core::{Forecast, ForecastError, Forecaster, WeightedGoals};
use ddl_data::{Convention, Dataset, HORIZON, OBSERVED, Position, Window, WindowRule};
use ddl_eval::baseline::{self, GoalSource, StraightLine};
use ddl_eval::metric::stability::RolloutStability;
use ddl_eval::{Conditions, Protocol, ResultRow};
use ddl_report::{
    EpochPoint, ForecastSnapshot, Report, TrainingCurve, gallery,
    page::{Page, Viewer},
};

/// The goals of a pedestrian form a fan of these turns and speeds.
const TURNS_DEG: [f64; 5] = [-38.0, -15.0, 0.0, 15.0, 38.0];
const SPEEDS: [f64; 4] = [0.45, 0.8, 1.0, 1.2];
/// Number of windows on the page with only the player.
const MOMENTS: usize = 8;

#[derive(Clone, Copy)]
struct Fan;

impl Fan {
    fn of(observed: &[Position]) -> (Vec<Position>, Vec<f64>) {
        let (first, last) = (observed[3], observed[OBSERVED - 1]);
        let ahead = [0, 1].map(|axis| (last[axis] - first[axis]) / 4.0 * HORIZON as f64);
        let mut goals = Vec::new();
        let mut weights = Vec::new();
        for turn in TURNS_DEG {
            let (sin, cos) = turn.to_radians().sin_cos();
            for speed in SPEEDS {
                goals.push([
                    last[0] + speed * (cos * ahead[0] - sin * ahead[1]),
                    last[1] + speed * (sin * ahead[0] + cos * ahead[1]),
                ]);
                weights.push((-(turn / 20.0).powi(2) - ((speed - 1.0) / 0.3).powi(2)).exp());
            }
        }
        let sum: f64 = weights.iter().sum();
        (goals, weights.iter().map(|w| w / sum).collect())
    }
}

impl GoalSource for Fan {
    fn name(&self) -> String {
        "a fan of 20 goals".to_owned()
    }

    fn goals(&self, window: &Window) -> Result<Vec<WeightedGoals>, ForecastError> {
        let goals_of = |i| {
            let (goals, weights) = Fan::of(window.observed(i));
            Ok(WeightedGoals::new(goals, weights)?)
        };
        (0..window.len()).map(goals_of).collect()
    }
}

/// A forecaster whose paths start with the observed velocity and bend to the goal, which they nearly reach.
struct Bending;

/// A path from the current position and velocity to the goal.
fn way(observed: &[Position], goal: Position) -> Vec<Position> {
    let (before, last) = (observed[OBSERVED - 2], observed[OBSERVED - 1]);
    (1..=HORIZON)
        .map(|t| {
            let s = t as f64 / HORIZON as f64;
            // A parabola that starts with the pedestrian's velocity, blended into the straight line.
            let fade = s * s * (3.0 - 2.0 * s);
            let along = 1.0 - (1.0 - s).powf(1.15);
            [0, 1].map(|axis| {
                let inertia = last[axis] + (last[axis] - before[axis]) * t as f64;
                let straight = last[axis] + 0.985 * along * (goal[axis] - last[axis]);
                (1.0 - fade) * inertia + fade * straight
            })
        })
        .collect()
}

impl Forecaster for Bending {
    fn name(&self) -> String {
        "bending to a fan of 20 goals".to_owned()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        let (mut positions, mut weights, mut goals, mut certified) = (vec![], vec![], vec![], vec![]);
        for i in 0..window.len() {
            let observed = window.observed(i);
            let (fan, fan_weights) = Fan::of(observed);
            for goal in &fan {
                let path = way(observed, *goal);
                let judged = RolloutStability::of(observed[OBSERVED - 1], &path, *goal);
                certified.push(judged.decreasing && judged.largest_turn < 75.0);
                positions.extend(path);
            }
            weights.extend(fan_weights);
            goals.extend(fan);
        }
        let k = weights.len() / window.len();
        let forecast = Forecast::new(window.len(), k, positions, weights, Some(goals))?;
        Ok(forecast.with_certified(certified)?)
    }
}

fn rows(fold: &str, windows: &[Window], rule: WindowRule) -> Result<Vec<ResultRow>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for protocol in Protocol::ALL {
        let named = |forecaster: String| Conditions {
            device: "cpu".to_owned(),
            commit: "example".to_owned(),
            ..Conditions::new(Convention::Simulated, rule, protocol, fold, forecaster)
        };
        for forecaster in [&Bending as &dyn Forecaster, &StraightLine::to(Fan)] {
            rows.push(ResultRow::measure(named(forecaster.name()), forecaster, windows)?);
        }
        // Two seeds; rows of forecasters without randomness are equal and kept once.
        for seed in [1, 2] {
            rows.extend(baseline::measure(&named(String::new()), windows, seed)?);
        }
    }
    Ok(rows)
}

fn under_way(windows: &[Window]) -> Result<Vec<ForecastSnapshot>, Box<dyn Error>> {
    let spread = windows.iter().step_by((windows.len() / MOMENTS).max(1));
    let mut moments = Vec::new();
    for (index, window) in spread.enumerate() {
        let under_way = window.without_future();
        let forecast = Bending.forecast(&under_way)?;
        let seen: Vec<Vec<Position>> = (0..window.len())
            .map(|i| {
                let steps = HORIZON.saturating_sub(5 * index * (i % 3)) * usize::from(index + 1 < MOMENTS);
                window.track(i)[OBSERVED..OBSERVED + steps].to_vec()
            })
            .collect();
        moments.push(ForecastSnapshot::under_way(
            Bending.name(),
            &under_way,
            &forecast,
            &seen,
        )?);
    }
    Ok(moments)
}

fn made_up(folds: &[&str]) -> Vec<TrainingCurve> {
    let mut curves = Vec::new();
    let variants = ["full", "no-dynamics", "no-goal-shift"];
    let pairs = (0..folds.len()).flat_map(|f| (0..variants.len()).map(move |v| (f, v)));
    for ((f, v), seed) in pairs.flat_map(|pair| [(pair, 1), (pair, 2)]) {
        let floor = 0.02 + 0.006 * f as f64 + 0.012 * v as f64;
        let wobble = |epoch: usize| (TAU * (0.37 * epoch as f64 + 0.3 * seed as f64)).sin();
        let point = |epoch: usize| {
            let descent = (-(epoch as f64) / (4.0 + v as f64)).exp();
            let error = 5.0 * floor * (1.0 + 0.05 * wobble(epoch + 3)) + 0.5 * descent;
            EpochPoint {
                epoch,
                loss: floor * (1.0 + 0.04 * wobble(epoch)) + 0.3 * descent,
                validation: Some(error),
                seconds: 12.0,
            }
        };
        curves.push(TrainingCurve {
            fold: folds[f].to_owned(),
            variant: variants[v].to_owned(),
            seed,
            loss: "made-up loss for this example (nothing was trained), m²".to_owned(),
            epochs: (1..=30).map(point).collect(),
        });
    }
    curves
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder] = arguments.as_slice() else {
        return Err("usage: report_page FOLDER".into());
    };
    let folder = Path::new(folder);
    let dataset = Dataset::simulated(1);
    let (mut results, mut shown) = (Vec::new(), Vec::new());
    for fold in dataset.folds() {
        let windows = fold.test_windows(WindowRule::Published);
        results.extend(rows(fold.name(), &windows, WindowRule::Published)?);
        let complete = fold.test_windows(WindowRule::Complete);
        results.extend(rows(fold.name(), &complete, WindowRule::Complete)?);
        let forecasts = Protocol::Fair.forecast(&Bending, &windows)?;
        let name = Bending.name();
        shown.extend(gallery::moments(fold.name(), &name, &windows, &forecasts)?);
    }
    let report = Report::new("Stand-in forecasters on simulated crowds", results)?;
    let curves = made_up(&dataset.fold_names());
    let page = Page {
        report: &report,
        moments: &shown,
        curves: &curves,
    };

    std::fs::create_dir_all(folder.join("figures"))?;
    std::fs::write(folder.join("page.html"), page.to_html()?)?;
    let crowd = dataset.folds()[0].test_windows(WindowRule::Published);
    let viewer = Viewer {
        title: "Pedestrians that leave the view",
        lead: "A simulated crowd, and a stand-in for a forecaster.",
        notes: &[],
        moments: &under_way(&crowd)?,
    };
    std::fs::write(folder.join("viewer.html"), viewer.to_html()?)?;
    for (name, svg) in page.figures()? {
        std::fs::write(folder.join("figures").join(name), svg)?;
    }
    std::fs::write(folder.join("report.json"), report.to_json()?)?;
    std::fs::write(folder.join("moments.json"), serde_json::to_string(&shown)?)?;
    Ok(())
}
