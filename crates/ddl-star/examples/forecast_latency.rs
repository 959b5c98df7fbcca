//! How long the network takes to forecast one scene: 25 walkers, 20 goals each, 12 frames.
//!
//! `RAYON_NUM_THREADS=1 cargo run --release -p ddl-star --example forecast_latency [rounds [widths]]` prints, for
//! feed-forward blocks 64 and 2048 wide or those that are named, the time of one forecast on one core: the least and the median of the rounds. On Linux it is processor
//! time, which says the same on a machine that others use as well.

#![expect(clippy::print_stdout, reason = "what it is for")]

use std::error::Error;
use std::hint::black_box;
use std::sync::LazyLock;
use std::time::Instant;

use ddl_data::{PedestrianId, Position, Window};
use ddl_star::{
    ComputeDevice, DeviceChoice, Noise, StarConfig, StarNetwork, StepRule, Variant, set_threads,
};

const WALKERS: u32 = 25;
const GOALS: u32 = 20;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let rounds: usize = arguments.next().map_or(Ok(50), |rounds| rounds.parse())?;
    let widths: Vec<i64> = arguments
        .map(|width| width.parse())
        .collect::<Result<_, _>>()?;
    let widths = if widths.is_empty() {
        vec![64, 2048]
    } else {
        widths
    };
    let device = ComputeDevice::open(DeviceChoice::Cpu)?;
    set_threads(1);
    let window = scene()?;
    let goals = vec![goals(&window)];
    let windows = [window];
    for feed_forward_width in widths {
        let config = StarConfig {
            feed_forward_width,
            ..StarConfig::published(Variant::Full)
        };
        let network = StarNetwork::new(config, 1, device)?;
        let forecast =
            || network.forecast_windows(&windows, &goals, Noise::Expected, StepRule::StableEuler);
        black_box(forecast()?);
        let mut times = Vec::new();
        for _ in 0..rounds.max(1) {
            let start = milliseconds();
            black_box(forecast()?);
            times.push(milliseconds() - start);
        }
        times.sort_by(f64::total_cmp);
        println!(
            "feed-forward width {feed_forward_width:>4}: least {:.2} ms, median {:.2} ms",
            times[0],
            times[times.len() / 2]
        );
    }
    Ok(())
}

/// Walkers on a square of 6 m, in all directions: some see each other, some do not.
fn scene() -> Result<Window, Box<dyn Error>> {
    let track = |i: u32| {
        let heading = f64::from(i) * 2.4;
        let (x, y) = (f64::from(i % 5) * 1.5, f64::from(i / 5) * 1.5);
        let at = |t: u32| {
            let way = 0.4 * (0.6 + 0.04 * f64::from(i)) * f64::from(t);
            [x + way * heading.cos(), y + way * heading.sin()]
        };
        (0..8).map(at).collect()
    };
    let tracks = (0..WALKERS).map(track).collect();
    let pedestrians = (0..WALKERS).map(|i| PedestrianId(i.into())).collect();
    Ok(Window::new("square", 0, 10, pedestrians, tracks)?)
}

/// Ends around where the walkers would be if they walked on.
fn goals(window: &Window) -> Vec<Vec<Position>> {
    let of = |i: usize| {
        let observed = window.observed(i);
        let ([x, y], [bx, by]) = (observed[7], observed[6]);
        let around = |k: u32| {
            let angle = f64::from(k) * 0.31;
            [
                x + 12.0 * (x - bx) + angle.cos(),
                y + 12.0 * (y - by) + angle.sin(),
            ]
        };
        (0..GOALS).map(around).collect()
    };
    (0..window.len()).map(of).collect()
}

/// Time that this process has spent on processors, or where that is not known, time that has passed.
fn milliseconds() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    spent().unwrap_or_else(|| START.elapsed().as_secs_f64() * 1e3)
}

fn spent() -> Option<f64> {
    let mut nanoseconds = 0.0;
    for thread in std::fs::read_dir("/proc/self/task").ok()? {
        let spent = std::fs::read_to_string(thread.ok()?.path().join("schedstat")).ok()?;
        nanoseconds += spent.split(' ').next()?.parse::<f64>().ok()?;
    }
    Some(nanoseconds / 1e6)
}
