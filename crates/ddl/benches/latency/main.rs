//! What a forecast and a training step cost, beside what the machine can do: `cargo bench -p ddl --features torch --bench latency`.
//!
//! One scene of 25 simulated pedestrians with 20 hypotheses each, on one thread: the whole forecast, and its parts: goals, network,
//! and walk with certificate in `f64`. The same for narrower feed-forward blocks. Then a training step of about 266 walkers, on one
//! thread and on two. The weights are untrained, which costs the same.
//!
//! Every figure is a median of turns; in each turn, right before, two large matrices are multiplied by libtorch in `f32` on as many
//! threads. The network's multiplications and additions (`StarConfig::forecast_operations`, `training_operations`) per second
//! are stated as a share of that product's. Times are the processor's, which other work on the machine hardly touches, and for two
//! threads the clock's, which it does.

mod clock;
mod scene;
mod step;
mod untrained;
mod walk;

use clock::{Clock, Measured, side_by_side};
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
    writeln!(out, "{}", header())?;
    for width in WIDTHS {
        untrained::widen(&run, width)?;
        let row = forecast(run.path(), &window, turns)?;
        writeln!(out, "{}", row.line(width))?;
    }
    writeln!(out, "\ntraining step, published network")?;
    for threads in [1, 2] {
        writeln!(out, "{}", step::measured(&dataset, threads, turns)?)?;
    }
    Ok(())
}

/// What one forecast costs.
struct Row {
    whole: Measured,
    goals: Measured,
    network: Measured,
    walk: Measured,
    operations: u64,
}

fn header() -> String {
    format!(
        "{:>12} {:>9} {:>9} {:>9} {:>9} {:>9} {:>13} {:>10} {:>14}",
        "feed-forward",
        "whole/ms",
        "goals/ms",
        "netw./ms",
        "walk/ms",
        "GFLOP",
        "network GF/s",
        "matmul GF/s",
        "network share"
    )
}

impl Row {
    fn line(&self, width: i64) -> String {
        let ms = |measured: &Measured| 1e3 * measured.seconds;
        let rate = self.operations as f64 / self.network.seconds;
        format!(
            "{width:>12} {:>9.2} {:>9.2} {:>9.2} {:>9.2} {:>9.2} {:>13.1} {:>10.1} {:>13.0}%",
            ms(&self.whole),
            ms(&self.goals),
            ms(&self.network),
            ms(&self.walk),
            self.operations as f64 / 1e9,
            rate / 1e9,
            self.network.matrix_rate / 1e9,
            100.0 * rate / self.network.matrix_rate,
        )
    }
}

/// The whole forecast, as a user asks for it, and its parts.
fn forecast(run: &Path, window: &Window, turns: usize) -> Result<Row> {
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
    let [whole, goals_cost, network_cost, walk_cost] =
        side_by_side(Clock::Processor, 1, turns, parts)?;
    Ok(Row {
        whole,
        goals: goals_cost,
        network: network_cost,
        walk: walk_cost,
        operations: star.forecast_operations(window.len(), rollout.hypotheses),
    })
}
