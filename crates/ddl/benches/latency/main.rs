//! What a forecast and a training step cost: `cargo bench -p ddl --features torch --bench latency`. One scene of 25
//! simulated pedestrians with 20 hypotheses each, or a step of about 266 walkers. Figures are medians of turns, each
//! after the caches are emptied: processor time, for two threads the time of the clock. Weights are untrained.

mod clock;
mod scene;
mod step;
mod untrained;
mod walk;

use clock::{Clock, side_by_side};
use ddl::data::{Dataset, Position, Window};
use ddl::network::weights::load_weights;
use ddl::network::{ForecastWindows as _, MotionNetwork, Noise, StepRule};
use ddl::{Ddl, DeviceChoice, Forecaster as _, RunDirectory};
use std::error::Error;
use std::io::Write as _;
use std::path::Path;

type Result<T> = std::result::Result<T, Box<dyn Error + Send + Sync>>;

/// Widths of the feed-forward blocks; the first is the published one.
const WIDTHS: [i64; 7] = [2048, 512, 256, 128, 64, 32, 16];

fn main() -> Result<()> {
    // `cargo bench` says so; anything else wants to see that it runs.
    let turns = if std::env::args().any(|argument| argument == "--bench") {
        11
    } else {
        1
    };
    ddl::prepare(DeviceChoice::Cpu, Some(1))?;
    let dataset = Dataset::simulated(1);
    let window = scene::of(&dataset)?;
    let folder = tempfile::tempdir()?;
    let run = untrained::run(&dataset, folder.path())?;
    let mut out = std::io::stdout().lock();
    let library = Ddl::load(run.path(), DeviceChoice::Cpu)?;
    let library = library
        .goal_model()
        .estimator()
        .map_or(0, |estimator| estimator.library().len());
    writeln!(
        out,
        "\n{} pedestrians, 20 hypotheses, {library} experts, one thread, processor time",
        window.len()
    )?;
    writeln!(out, "feed-forward  whole/ms  goals/ms network/ms   walk/ms")?;
    for width in WIDTHS {
        untrained::widen(&run, width)?;
        let [whole, goals, network, walk] =
            forecast(run.path(), &window, turns)?.map(|seconds| 1e3 * seconds);
        writeln!(
            out,
            "{width:>12} {whole:>9.2} {goals:>9.2} {network:>10.2} {walk:>9.2}"
        )?;
    }
    writeln!(out, "\ntraining step, published network")?;
    for threads in [1, 2] {
        writeln!(out, "{}", step::measured(&dataset, threads, turns)?)?;
    }
    Ok(())
}

/// Seconds of the whole forecast, as a user asks for it, and of its parts: goals, network, walk.
fn forecast(run: &Path, window: &Window, turns: usize) -> Result<[f64; 4]> {
    let model = Ddl::load(run, DeviceChoice::Cpu)?;
    let star = &model.config().star;
    let network = MotionNetwork::new(star.clone(), 0)?;
    let origin = model.config().network_origin();
    let weights = load_weights(
        network.weights().layout(),
        &origin,
        &RunDirectory::new(run).model(),
    )?;
    let network = network.with_weights(weights)?;
    let windows = std::slice::from_ref(window);
    let sets = model.goal_model().goals(windows)?.remove(0);
    let goals: Vec<Vec<Position>> = sets.iter().map(|set| set.goals().to_vec()).collect();
    let all = vec![goals.clone()];
    let roll_out =
        || network.forecast_windows(windows, &all, Noise::Expected, StepRule::Bounded, None);
    let rollout = roll_out()?.remove(0);
    let parts: [&mut dyn FnMut() -> Result<()>; 4] = [
        &mut || model.forecast(window).map(drop).map_err(Into::into),
        &mut || {
            model
                .goal_model()
                .goals(windows)
                .map(drop)
                .map_err(Into::into)
        },
        &mut || roll_out().map(drop).map_err(Into::into),
        &mut || walk::all(star, window, &goals, &rollout),
    ];
    side_by_side(Clock::Processor, turns, parts)
}
