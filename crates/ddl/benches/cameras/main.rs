//! How many cameras one core can forecast: `cargo bench -p ddl-forecast --bench cameras`, or with `-- 60 150` only
//! these numbers of cameras.
//!
//! Every camera sees 12 pedestrians and sends 2.5 frames per second, at its own times. One thread does all the work: a
//! built-in model observes and forecasts every frame, with 20 hypotheses per pedestrian. Time is simulated: it advances
//! by the processor time of the work, and idle time is skipped. So other load on the machine disturbs little, and hours
//! pass in seconds.

mod cameras;
mod queue;

use cameras::{FRAME, PEDESTRIANS};
use ddl::{BuiltinModel, Ddl, DeviceChoice, LiveScenes};
use queue::Phases;
use std::error::Error;
use std::io::Write as _;

type Result<T> = std::result::Result<T, Box<dyn Error + Send + Sync>>;

/// Cameras of the table.
const CAMERAS: [usize; 8] = [1, 10, 30, 60, 100, 150, 200, 300];
/// Smallest number of frames, forecast or dropped, for a row of the table.
const FRAMES: usize = 900;
/// Smallest number of frames of every camera.
const FRAMES_EACH: usize = 6;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    // `cargo bench` passes this argument; without it, this only checks that the benchmark runs.
    let is_measured = arguments.iter().any(|argument| argument == "--bench");
    let given: Vec<usize> = arguments.iter().filter_map(|it| it.parse().ok()).collect();
    let counts = match (is_measured, given.is_empty()) {
        (false, _) => &[1, 3][..],
        (true, true) => &CAMERAS,
        (true, false) => &given,
    };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    one.install(|| measure(counts, is_measured))
}

fn measure(counts: &[usize], is_measured: bool) -> Result<()> {
    let mut out = std::io::stdout().lock();
    let model = Ddl::builtin(BuiltinModel::Hotel, DeviceChoice::Cpu)?;
    let sizes: &[usize] = if is_measured { &[1, 2, 4, 8, 16] } else { &[1, 2] };
    writeln!(out, "| cameras in a batch | ms a camera |\n|---:|---:|")?;
    let mut alone = 0.0;
    for &size in sizes {
        let seconds = queue::service(&model, size, if is_measured { 160 } else { size })?;
        if size == 1 {
            alone = seconds;
        }
        writeln!(out, "| {size} | {:.2} |", 1e3 * seconds)?;
    }
    writeln!(
        out,
        "\n| cameras | busy, % | p50, ms | p99, ms | dropped, % | p99 if all frames come at once, ms |\n\
         |---:|---:|---:|---:|---:|---:|"
    )?;
    let frames = |cameras: usize| {
        if is_measured {
            (FRAMES / cameras).max(FRAMES_EACH)
        } else {
            2
        }
    };
    for &cameras in counts {
        let with_own_phases = queue::simulated(&model, cameras, frames(cameras), Phases::Own)?;
        let at_once = queue::simulated(&model, cameras, frames(cameras), Phases::AtOnce)?;
        let [p50, p99] = [0.5, 0.99].map(|share| 1e3 * with_own_phases.latency(share));
        writeln!(
            out,
            "| {cameras} | {:.0} | {p50:.1} | {p99:.1} | {:.1} | {:.0} |",
            100.0 * with_own_phases.busy,
            100.0 * with_own_phases.dropped_share(),
            1e3 * at_once.latency(0.99)
        )?;
    }
    let capacity = FRAME / alone;
    let cameras = if is_measured {
        (2.0 * capacity).round() as usize
    } else {
        2
    };
    let cameras = cameras.clamp(1, LiveScenes::MOST_SCENES);
    let figures = queue::simulated(&model, cameras, frames(cameras).min(20), Phases::Own)?;
    let [p50, p99] = [0.5, 0.99].map(|share| 1e3 * figures.latency(share));
    writeln!(
        out,
        "\ntwice as many as one core forecasts ({capacity:.0}): {cameras} cameras, {} of {} frames forecast, {} \
         dropped for later ones, p50 {p50:.0} ms, p99 {p99:.0} ms",
        figures.latencies.len(),
        figures.frames,
        figures.dropped,
    )?;
    let [tracks, waiting] = queue::memory(if is_measured { 1_000 } else { 2 })?;
    writeln!(
        out,
        "memory of a camera: {tracks:.1} KiB, and {waiting:.1} KiB while a frame waits ({PEDESTRIANS} pedestrians each)"
    )?;
    Ok(())
}
