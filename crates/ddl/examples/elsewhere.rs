//! The built-in models on recordings of places that no model was trained on: `elsewhere FOLDER=FPS ...`.
//!
//! Folders hold csv files (frame, pedestrian, x, y in metres). All tables are printed; those of the default model by
//! place go into `docs/elsewhere.md`.

#![expect(clippy::print_stdout, reason = "a program that prints tables")]

mod page;
mod places;

use ddl::data::{Dataset, HORIZON, OBSERVED, Position, TIME_STEP, Window};
use ddl::eval::baseline::ConstantVelocity;
use ddl::eval::metric::displacement::DisplacementErrors;
use ddl::eval::metric::stability::StabilityScores;
use ddl::eval::significance::{BlockErrors, BlockMetric, block_errors, paired_difference};
use ddl::eval::{Scene, Scores};
use ddl::{BuiltinModel, Ddl, DeviceChoice, Forecast, Forecaster, Protocol, Remembering};
use places::{Part, Place};
use std::error::Error;

/// Approximate number of pedestrian-windows of a folder. Larger folders are sampled evenly.
const PEDESTRIANS: usize = 3000;
const CHUNK: usize = 64;
/// Speed (m/s) above which a pedestrian is taken to run or ride.
const FAST: f64 = 3.0;
const SEED: u64 = 0;

const RATIO: &str = "ratio of the minADE";
/// The measures of a model: the columns of its table and the rows of the page.
const MEASURES: [&str; 12] = [
    "`fair`",
    "straight lines to the same goals",
    RATIO,
    "`single`",
    "log loss (nats)",
    "AMD",
    "regions of 50 % and 90 %",
    "radius (m)",
    "certified",
    "familiarity",
    "faster than 3 m/s",
    "of these `fair`, straight lines",
];

/// Results of the default model and the baselines at one place: name and value.
type Figures = Vec<(&'static str, String)>;

fn main() -> Result<(), Box<dyn Error>> {
    let places: Vec<Place> = std::env::args()
        .skip(1)
        .map(|place| Place::read(&place, Part::Rest, PEDESTRIANS))
        .collect::<Result<_, _>>()?;
    if places.is_empty() {
        return Err("usage: elsewhere FOLDER=FPS ...".into());
    }
    ddl::prepare(DeviceChoice::Cpu, None)?;
    let models: Vec<(BuiltinModel, Ddl)> = BuiltinModel::ALL
        .into_iter()
        .map(|model| Ok((model, Ddl::builtin(model, DeviceChoice::Cpu)?)))
        .collect::<Result<_, ddl::DdlError>>()?;
    let mut of_places = Vec::new();
    for place in &places {
        println!(
            "\n# {}: {} recordings, {} frames a second, {} pedestrian-windows\n",
            place.name,
            place.recordings.len(),
            place.rate,
            count(&place.windows)
        );
        of_places.push(print_place(place, &models)?);
    }
    page::publish("elsewhere.md", &summary(&places, &of_places))
}

fn print_place(place: &Place, models: &[(BuiltinModel, Ddl)]) -> Result<Figures, Box<dyn Error>> {
    let mut figures = baselines(&place.windows)?;
    println!("| baseline | errors |\n|---|---|");
    for (name, errors) in &figures {
        println!("| {name} | {errors} |");
    }
    println!("\n| model | {} |", MEASURES.join(" | "));
    println!("|{}", "---|".repeat(MEASURES.len() + 1));
    let mut ratios = Vec::new();
    for (name, model) in models {
        let (ratio, cells) = measure(model, &place.windows)?;
        println!("| {} | {} |", name.name(), cells.join(" | "));
        ratios.push(ratio);
        if *name == BuiltinModel::default() {
            figures.extend(MEASURES.into_iter().zip(cells));
        }
    }
    ratios.sort_by(f64::total_cmp);
    let range = format!("{:.3} to {:.3}", ratios[0], ratios[ratios.len() - 1]);
    let after = figures.iter().position(|(name, _)| *name == RATIO);
    figures.insert(after.map_or(0, |at| at + 1), ("that ratio of the five models", range));
    let default = models.iter().find(|(name, _)| *name == BuiltinModel::default());
    if let Some((name, model)) = default {
        print_recordings(name.name(), model, &place.windows)?;
        figures.extend(print_watching(name.name(), model, place)?);
    }
    Ok(figures)
}

/// A column for each place.
fn summary(places: &[Place], of_places: &[Figures]) -> String {
    let row = |name: &str, cells: &[String]| format!("| {name} | {} |\n", cells.join(" | "));
    let of_each = |cell: fn(&Place) -> String| places.iter().map(cell).collect::<Vec<_>>();
    let mut table = row("", &of_each(|place| place.name.clone()));
    table += &row("---", &of_each(|_| "---".to_owned()));
    let recordings = of_each(|place| place.recordings.len().to_string());
    table += &row("recordings", &recordings);
    let windows = of_each(|place| count(&place.windows).to_string());
    table += &row("pedestrian-windows", &windows);
    for (at, (name, _)) in of_places[0].iter().enumerate() {
        let cells: Vec<String> = of_places.iter().map(|of| of[at].1.clone()).collect();
        table += &row(name, &cells);
    }
    table
}

fn count(windows: &[Window]) -> usize {
    windows.iter().map(Window::len).sum()
}

fn baselines(windows: &[Window]) -> Result<Figures, Box<dyn Error>> {
    let forecasters = [
        ("constant velocity, last step (`single`)", ConstantVelocity::last_step()),
        (
            "constant velocity, mean observed (`single`)",
            ConstantVelocity::mean_observed(),
        ),
        (
            "constant velocity, 20 noisy samples (`fair`)",
            ConstantVelocity::angular_noise(SEED),
        ),
    ];
    let measured = forecasters.into_iter().map(|(name, forecaster)| {
        let forecasts = forecaster.forecast_all(&Protocol::Fair.visible(windows))?;
        let scores = Scores::evaluate(windows, &forecasts)?;
        Ok((name, format!("{:.3}/{:.3}", scores.min_ade, scores.min_fde)))
    });
    measured.collect()
}

/// The ratio of the model's minADE to that of straight lines, and a cell for each of the [`MEASURES`].
fn measure(model: &Ddl, windows: &[Window]) -> Result<(f64, Vec<String>), Box<dyn Error>> {
    let (mut ours, mut ones, mut lines) = (Vec::new(), Vec::new(), Vec::new());
    for chunk in windows.chunks(CHUNK) {
        let seen = Protocol::Fair.visible(chunk);
        ones.extend(model.forecast_central(&seen)?);
        for (window, forecast) in seen.iter().zip(model.forecast_all(&seen)?) {
            lines.push(straight_lines(window, &forecast)?);
            ours.push(forecast);
        }
    }
    let scores = Scores::evaluate(windows, &ours)?;
    let of_lines = Scores::evaluate(windows, &lines)?;
    let one = Scores::evaluate(windows, &ones)?;
    let (a, b) = (block_errors(windows, &ours)?, block_errors(windows, &lines)?);
    let interval = interval(&a, &b, of_lines.min_ade)?;
    let number = |x: Option<f64>| x.unwrap_or(f64::NAN);
    let [half, most] = scores.coverage.unwrap_or([f64::NAN; 2]).map(|share| 100.0 * share);
    let certified = scores.stability.as_ref().and_then(|s: &StabilityScores| s.certified);
    let errors = |scores: &Scores| format!("{:.3}/{:.3}", scores.min_ade, scores.min_fde);
    let ratio = scores.min_ade / of_lines.min_ade;
    let radius = scores.region_radius.map_or(f64::NAN, |[_, radius]| radius);
    let [fast, of_fast] = runners(windows, &ours, &lines)?;
    let cells = vec![
        errors(&scores),
        errors(&of_lines),
        format!("{ratio:.3}{interval}"),
        errors(&one),
        format!("{:.2}", number(scores.weight_log_loss)),
        format!("{:.2}", number(scores.amd)),
        format!("{half:.1} / {most:.1} %"),
        format!("{radius:.2}"),
        format!("{:.1} %", 100.0 * number(certified)),
        format!("{:.2}", number(scores.familiarity)),
        fast,
        of_fast,
    ];
    Ok((ratio, cells))
}

fn print_recordings(name: &str, model: &Ddl, windows: &[Window]) -> Result<(), Box<dyn Error>> {
    let of_one: Vec<&[Window]> = windows.chunk_by(|a, b| a.recording() == b.recording()).collect();
    if of_one.len() < 2 {
        return Ok(());
    }
    println!(
        "\n| recording (`{name}`) | pedestrian-windows | `fair` | noisy constant velocity | `single` | better \
         constant velocity | regions 50 / 90 % | radius | familiarity |\n\
         |---|---|---|---|---|---|---|---|---|"
    );
    for windows in of_one {
        let seen = Protocol::Fair.visible(windows);
        let ours = Scores::evaluate(windows, &model.forecast_all(&seen)?)?;
        let one = Scores::evaluate(windows, &model.forecast_central(&seen)?)?;
        let of = |velocity: ConstantVelocity| {
            Ok::<_, Box<dyn Error>>(Scores::evaluate(windows, &velocity.forecast_all(&seen)?)?)
        };
        let (last, mean) = (
            of(ConstantVelocity::last_step())?,
            of(ConstantVelocity::mean_observed())?,
        );
        let noisy = of(ConstantVelocity::angular_noise(SEED))?;
        let better = if last.min_ade <= mean.min_ade { last } else { mean };
        let [half, most] = ours.coverage.unwrap_or([f64::NAN; 2]).map(|share| 100.0 * share);
        println!(
            "| {} | {} | {:.3}/{:.3} | {:.3}/{:.3} | {:.3}/{:.3} | {:.3}/{:.3} | {half:.1} / {most:.1} % | {:.2} | \
             {:.2} |",
            windows[0].recording(),
            ours.pedestrians,
            ours.min_ade,
            ours.min_fde,
            noisy.min_ade,
            noisy.min_fde,
            one.min_ade,
            one.min_fde,
            better.min_ade,
            better.min_fde,
            ours.region_radius.map_or(f64::NAN, |[_, radius]| radius),
            ours.familiarity.unwrap_or(f64::NAN),
        );
    }
    Ok(())
}

/// Evaluates the same windows with a memory of their recording up to that time, as for a camera that has observed the
/// place from the start.
fn print_watching(name: &str, model: &Ddl, place: &Place) -> Result<Figures, Box<dyn Error>> {
    let dataset = Dataset::own(place.recordings.clone())?;
    let goals = model.goal_model();
    let online = goals.remembering(&place.windows, &dataset, Remembering::Online)?;
    let minutes = |recording: &str| {
        let of_name = dataset.recordings().iter().find(|r| r.name() == recording);
        of_name.map_or(0.0, |recording| {
            let frames = recording.frames();
            let steps = (frames[frames.len() - 1] - frames[0]) as f64 / recording.frame_step() as f64;
            steps * TIME_STEP / 60.0
        })
    };
    println!(
        "\nWith a memory of the recording (protocols `online` and `online-single`, numbers of their own):\n\n\
         | recording (`{name}`) | minutes | pedestrian-windows | `fair` | `online` | minFDE | `single` | \
             `online-single` | FDE |\n\
         |---|---|---|---|---|---|---|---|---|"
    );
    let of_one = || {
        place
            .windows
            .chunk_by(|a, b| a.recording() == b.recording())
            .zip(online.chunk_by(|a, b| a.recording() == b.recording()))
    };
    for (alone, watching) in of_one() {
        let recording = alone[0].recording();
        let minutes = format!("{:.1}", minutes(recording));
        print_change(recording, &minutes, model, (alone, watching))?;
    }
    let [many, one] = print_change("all", "", model, (&place.windows, &online))?;
    Ok(vec![
        ("`online` (change of the minFDE)", many),
        ("`online-single` (change of the FDE)", one),
    ])
}

/// Prints a row. Errors with the memory and their change, under `online` and `online-single`.
fn print_change(
    recording: &str,
    minutes: &str,
    model: &Ddl,
    (alone, watching): (&[Window], &[Window]),
) -> Result<[String; 2], Box<dyn Error>> {
    let scored = |windows: &[Window]| {
        let seen = Protocol::Online.visible(windows);
        let scores = [model.forecast_all(&seen)?, model.forecast_central(&seen)?];
        let [many, one] = scores.map(|forecasts| Scores::evaluate(windows, &forecasts));
        Ok::<_, Box<dyn Error>>([many?, one?])
    };
    let (before, after) = (scored(alone)?, scored(watching)?);
    let errors = |scores: &Scores| format!("{:.3}/{:.3}", scores.min_ade, scores.min_fde);
    let change = |at: usize| 100.0 * (after[at].min_fde / before[at].min_fde - 1.0);
    let cell = |at: usize| {
        let [alone, watching] = [&before[at], &after[at]].map(errors);
        format!("{alone} | {watching} | {:+.1} %", change(at))
    };
    println!(
        "| {recording} | {minutes} | {} | {} | {} |",
        before[0].pedestrians,
        cell(0),
        cell(1)
    );
    Ok([0, 1].map(|at| format!("{} ({:+.1} %)", errors(&after[at]), change(at))))
}

/// The number of pedestrians with a mean observed speed above 3 m/s, and the minADE of the model and of straight lines
/// on them.
fn runners(windows: &[Window], ours: &[Forecast], lines: &[Forecast]) -> Result<[String; 2], Box<dyn Error>> {
    let (mut count, mut sums) = (0, [0.0; 2]);
    for (window, pair) in windows.iter().zip(ours.iter().zip(lines)) {
        let errors = [pair.0, pair.1].map(|forecast| Scene::new(window, forecast));
        let [ours, lines] = errors.map(|scene| scene.map(|scene| DisplacementErrors::of(&scene)));
        let (ours, lines) = (ours?, lines?);
        for i in (0..window.len()).filter(|&i| mean_speed(window.observed(i)) > FAST) {
            count += 1;
            sums = [sums[0] + ours.min_ade(i), sums[1] + lines.min_ade(i)];
        }
    }
    let [ours, lines] = sums.map(|sum| sum / f64::from(count));
    let means = if count > 0 {
        format!("{ours:.3}, {lines:.3}")
    } else {
        "-".to_owned()
    };
    Ok([count.to_string(), means])
}

fn mean_speed(observed: &[Position]) -> f64 {
    let steps = observed.array_windows().map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1]));
    steps.sum::<f64>() / ((OBSERVED - 1) as f64 * TIME_STEP)
}

/// The interval of the ratio as text; empty if there are too few blocks.
fn interval(ours: &[BlockErrors], lines: &[BlockErrors], error: f64) -> Result<String, Box<dyn Error>> {
    let difference = paired_difference(&[ours], &[lines], BlockMetric::MinAde)?;
    Ok(difference.map_or_else(String::new, |paired| {
        let [low, high] = [paired.difference.low, paired.difference.high].map(|d| 1.0 + d / error);
        format!(" ({low:.3} to {high:.3})")
    }))
}

fn straight_lines(window: &Window, forecast: &Forecast) -> Result<Forecast, Box<dyn Error>> {
    let (mut positions, mut weights, mut goals) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..forecast.pedestrians() {
        let start = window.observed(i)[OBSERVED - 1];
        for k in 0..forecast.hypotheses() {
            let goal = forecast.goal(i, k).ok_or("the model has no goals")?;
            positions.extend((1..=HORIZON).map(|t| {
                let share = t as f64 / HORIZON as f64;
                [0, 1].map(|axis| start[axis] + share * (goal[axis] - start[axis]))
            }));
            weights.push(forecast.weight(i, k));
            goals.push(goal);
        }
    }
    Ok(Forecast::new(
        forecast.pedestrians(),
        forecast.hypotheses(),
        positions,
        weights,
        Some(goals),
    )?)
}
