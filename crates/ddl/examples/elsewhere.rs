//! The built-in models on recordings of places that no model was trained on: `elsewhere FOLDER=FPS ... > docs/elsewhere.md`.
//!
//! Folders hold csv files (frame, pedestrian, x, y in metres). Baselines, intervals, certificates, coverage and familiarity stand beside the errors.

#![expect(clippy::print_stdout, reason = "a program that prints a page")]

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

/// Pedestrian-windows of a folder, about: evenly spread where there are more.
const PEDESTRIANS: usize = 3000;
const CHUNK: usize = 64;
/// Who is faster than this (m/s) runs or rides.
const FAST: f64 = 3.0;
const SEED: u64 = 0;

const HEAD: &str = "# Other places

How the built-in models do where no model was trained: recordings of other places, other cameras and other annotators. Every complete window of
20 steps of 0.4 s; where a folder holds more than about 3,000 pedestrian-windows, evenly spread ones of it. Errors in metres, means over
pedestrian-windows: `fair` is minADE/minFDE of 20 hypotheses, `single` ADE/FDE of one. CPU.

Made by `cargo run --release -p ddl-forecast --example elsewhere -- FOLDER=FPS ... > docs/elsewhere.md`, folders and frames a second as below. The constants of
[calibration](accuracy.md#anywhere-people-walk) were chosen and fitted on recordings 1, 3, 5 and so on of each folder, of a single recording on its first half. The tables
are of the rest: other recordings of the same places; those without a window of 20 steps have no row. The networks have learned from none of them.
";

const NOTES: &str = "
*Ratio*: minADE of the model to that of straight lines to the same goals; the interval is that of the paired difference over blocks of 20 s (95 %), divided by the
minADE of the lines. *Noisy*: 20 samples of constant velocity with an angular noise of 25 degrees. *Log loss* of the weight of the goal nearest to
the true end, nats; lower is better, equal weights have 2.996. *AMD* ([protocols](protocols.md#4-metrics)): 1.25 is calibrated. *Regions*: share of true positions inside the regions of 50 % and 90 %; *radius* of
a disc of the same area as the region of 90 % at 4.8 s, metres. *Certified*: share of hypotheses whose certificate holds, bounds of speed, change of speed, deviation and
arrival included. *Familiarity*: mean; 0.5 where motions are as ordinary as in training. *Faster than 3 m/s*: number of pedestrian-windows whose mean
observed speed is above 3 m/s; minADE of the model and of straight lines on these.

A region as it was calibrated, which these are, holds its share on average over places like those that it was calibrated on. In a single recording it holds more or less, as
the tables by recording show; [regions that follow a place](regions.md) come to hold it there too. Familiarity
tells of single motions; it does not rank recordings by their errors.

*dut*: pedestrians beside a vehicle, filmed from above (Yang et al., *Top-view trajectories*, IV 2019). *edinburgh*: a forum filmed from above (Majecka, *Statistical models
of pedestrian behaviour in the Forum*, 2009). *sdd*: the Stanford Drone Dataset, pedestrians alone (Robicquet et al., ECCV 2016).
";

fn main() -> Result<(), Box<dyn Error>> {
    let places: Vec<Place> = std::env::args()
        .skip(1)
        .map(|place| Place::read(&place, Part::Rest, PEDESTRIANS))
        .collect::<Result<_, _>>()?;
    if places.is_empty() {
        return Err("usage: elsewhere FOLDER=FPS ...".into());
    }
    ddl::prepare(DeviceChoice::Cpu, None)?;
    println!("{HEAD}");
    for place in &places {
        println!(
            "- **{}**: {}, {} frames a second, {} pedestrian-windows",
            place.name,
            match place.recordings.len() {
                1 => "1 recording".to_owned(),
                recordings => format!("{recordings} recordings"),
            },
            place.rate,
            count(&place.windows)
        );
    }
    let models: Vec<(BuiltinModel, Ddl)> = BuiltinModel::ALL
        .into_iter()
        .map(|model| Ok((model, Ddl::builtin(model, DeviceChoice::Cpu)?)))
        .collect::<Result<_, ddl::DdlError>>()?;
    for place in &places {
        println!("\n## {}\n", place.name);
        print_baselines(place)?;
        println!(
            "\n| model | `fair` | straight lines | ratio | `single` | log loss | AMD | regions 50 / 90 % | radius | certified | familiarity | faster than 3 m/s |\n\
             |---|---|---|---|---|---|---|---|---|---|---|---|"
        );
        for (name, model) in &models {
            print_model(name.name(), model, &place.windows)?;
        }
        let default = models
            .iter()
            .find(|(name, _)| *name == BuiltinModel::default());
        if let Some((name, model)) = default {
            print_recordings(name.name(), model, &place.windows)?;
            print_watching(name.name(), model, place)?;
        }
    }
    println!("{NOTES}");
    Ok(())
}

fn count(windows: &[Window]) -> usize {
    windows.iter().map(Window::len).sum()
}

fn print_baselines(place: &Place) -> Result<(), Box<dyn Error>> {
    println!("| baseline | errors |\n|---|---|");
    for (name, forecaster) in [
        (
            "constant velocity, last step (`single`)",
            ConstantVelocity::last_step(),
        ),
        (
            "constant velocity, mean observed (`single`)",
            ConstantVelocity::mean_observed(),
        ),
        (
            "noisy constant velocity, 20 samples (`fair`)",
            ConstantVelocity::angular_noise(SEED),
        ),
    ] {
        let forecasts = forecaster.forecast_all(&Protocol::Fair.visible(&place.windows))?;
        let scores = Scores::evaluate(&place.windows, &forecasts)?;
        println!("| {name} | {:.3}/{:.3} |", scores.min_ade, scores.min_fde);
    }
    Ok(())
}

fn print_model(name: &str, model: &Ddl, windows: &[Window]) -> Result<(), Box<dyn Error>> {
    let (mut ours, mut ones, mut lines) = (Vec::new(), Vec::new(), Vec::new());
    for chunk in windows.chunks(CHUNK) {
        let seen = Protocol::Fair.visible(chunk);
        ones.extend(model.forecast_one(&seen)?);
        for (window, forecast) in seen.iter().zip(model.forecast_all(&seen)?) {
            lines.push(straight_lines(window, &forecast)?);
            ours.push(forecast);
        }
    }
    let scores = Scores::evaluate(windows, &ours)?;
    let of_lines = Scores::evaluate(windows, &lines)?;
    let one = Scores::evaluate(windows, &ones)?;
    let (a, b) = (
        block_errors(windows, &ours)?,
        block_errors(windows, &lines)?,
    );
    let interval = interval(&a, &b, of_lines.min_ade)?;
    let number = |x: Option<f64>| x.unwrap_or(f64::NAN);
    let [half, most] = scores
        .coverage
        .unwrap_or([f64::NAN; 2])
        .map(|share| 100.0 * share);
    let certified = scores
        .stability
        .as_ref()
        .and_then(|s: &StabilityScores| s.certified);
    println!(
        "| {name} | {:.3}/{:.3} | {:.3}/{:.3} | {:.3}{interval} | {:.3}/{:.3} | {:.2} | {:.2} | {half:.1} / {most:.1} % | {:.2} | {:.1} % | {:.2} | {} |",
        scores.min_ade,
        scores.min_fde,
        of_lines.min_ade,
        of_lines.min_fde,
        scores.min_ade / of_lines.min_ade,
        one.min_ade,
        one.min_fde,
        number(scores.weight_log_loss),
        number(scores.amd),
        scores.region_radius.map_or(f64::NAN, |[_, radius]| radius),
        100.0 * number(certified),
        number(scores.familiarity),
        runners(windows, &ours, &lines)?,
    );
    Ok(())
}

fn print_recordings(name: &str, model: &Ddl, windows: &[Window]) -> Result<(), Box<dyn Error>> {
    let of_one: Vec<&[Window]> = windows
        .chunk_by(|a, b| a.recording() == b.recording())
        .collect();
    if of_one.len() < 2 {
        return Ok(());
    }
    println!(
        "\n| recording (`{name}`) | pedestrian-windows | `fair` | noisy constant velocity | `single` | better constant velocity | regions 50 / 90 % | radius | familiarity |\n\
         |---|---|---|---|---|---|---|---|---|"
    );
    for windows in of_one {
        let seen = Protocol::Fair.visible(windows);
        let ours = Scores::evaluate(windows, &model.forecast_all(&seen)?)?;
        let one = Scores::evaluate(windows, &model.forecast_one(&seen)?)?;
        let of = |velocity: ConstantVelocity| {
            Ok::<_, Box<dyn Error>>(Scores::evaluate(windows, &velocity.forecast_all(&seen)?)?)
        };
        let (last, mean) = (
            of(ConstantVelocity::last_step())?,
            of(ConstantVelocity::mean_observed())?,
        );
        let noisy = of(ConstantVelocity::angular_noise(SEED))?;
        let better = if last.min_ade <= mean.min_ade {
            last
        } else {
            mean
        };
        let [half, most] = ours
            .coverage
            .unwrap_or([f64::NAN; 2])
            .map(|share| 100.0 * share);
        println!(
            "| {} | {} | {:.3}/{:.3} | {:.3}/{:.3} | {:.3}/{:.3} | {:.3}/{:.3} | {half:.1} / {most:.1} % | {:.2} | {:.2} |",
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

/// The same windows with a memory of their recording until then, as a camera has it that has watched from the start.
fn print_watching(name: &str, model: &Ddl, place: &Place) -> Result<(), Box<dyn Error>> {
    let dataset = Dataset::own(place.recordings.clone())?;
    let goals = model.goal_model();
    let online = goals.remembering(&place.windows, &dataset, Remembering::Online)?;
    let minutes = |recording: &str| {
        let of_name = dataset.recordings().iter().find(|r| r.name() == recording);
        of_name.map_or(0.0, |recording| {
            let frames = recording.frames();
            let steps =
                (frames[frames.len() - 1] - frames[0]) as f64 / recording.frame_step() as f64;
            steps * TIME_STEP / 60.0
        })
    };
    println!(
        "\nWith a memory of the recording (protocols `online` and `online-single`, numbers of their own):\n\n\
         | recording (`{name}`) | minutes | pedestrian-windows | `fair` | `online` | minFDE | `single` | `online-single` | FDE |\n\
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
    if of_one().count() > 1 {
        print_change("all", "", model, (&place.windows, &online))?;
    }
    Ok(())
}

fn print_change(
    recording: &str,
    minutes: &str,
    model: &Ddl,
    (alone, watching): (&[Window], &[Window]),
) -> Result<(), Box<dyn Error>> {
    let scored = |windows: &[Window]| {
        let seen = Protocol::Online.visible(windows);
        let scores = [model.forecast_all(&seen)?, model.forecast_one(&seen)?];
        let [many, one] = scores.map(|forecasts| Scores::evaluate(windows, &forecasts));
        Ok::<_, Box<dyn Error>>([many?, one?])
    };
    let (before, after) = (scored(alone)?, scored(watching)?);
    let cells = before.iter().zip(&after).map(|(before, after)| {
        format!(
            "{:.3}/{:.3} | {:.3}/{:.3} | {:+.1} %",
            before.min_ade,
            before.min_fde,
            after.min_ade,
            after.min_fde,
            100.0 * (after.min_fde / before.min_fde - 1.0)
        )
    });
    println!(
        "| {recording} | {minutes} | {} | {} |",
        before[0].pedestrians,
        cells.collect::<Vec<_>>().join(" | ")
    );
    Ok(())
}

/// minADE of those who were observed to be faster than 3 m/s on average, and of straight lines to the same goals, with their number.
fn runners(
    windows: &[Window],
    ours: &[Forecast],
    lines: &[Forecast],
) -> Result<String, Box<dyn Error>> {
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
    Ok(match count {
        0 => "none".to_owned(),
        _ => format!(
            "{count}: {:.3}, lines {:.3}",
            sums[0] / f64::from(count),
            sums[1] / f64::from(count)
        ),
    })
}

fn mean_speed(observed: &[Position]) -> f64 {
    let steps = observed
        .array_windows()
        .map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1]));
    steps.sum::<f64>() / ((OBSERVED - 1) as f64 * TIME_STEP)
}

/// The interval of the ratio, in words; none where there are too few blocks.
fn interval(
    ours: &[BlockErrors],
    lines: &[BlockErrors],
    error: f64,
) -> Result<String, Box<dyn Error>> {
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
