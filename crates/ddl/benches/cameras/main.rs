//! How many cameras one core can forecast: `cargo bench -p ddl-forecast --bench cameras`.
//!
//! Every camera sees 12 pedestrians and sends 2.5 frames per second, at its own times. One thread does all the work: a
//! built-in model observes and forecasts every frame, with 20 hypotheses per pedestrian. Time is simulated: it advances
//! by the processor time of the work, and idle time is skipped. So other load on the machine disturbs little, and hours
//! pass in seconds.

mod cameras;
mod queue;

use cameras::{FRAME, PEDESTRIANS};
use ddl::{BuiltinModel, Ddl, DeviceChoice};
use std::error::Error;
use std::io::Write as _;

type Result<T> = std::result::Result<T, Box<dyn Error + Send + Sync>>;

/// Cameras of the table, beside twice as many as one core forecasts.
const CAMERAS: [usize; 4] = [10, 30, 60, 100];
/// Cameras of a large batch.
const BATCH: usize = 16;
/// Smallest number of frames, forecast or dropped, for a row of the table.
const FRAMES: usize = 900;
/// Smallest number of frames of every camera.
const FRAMES_EACH: usize = 6;

fn main() -> Result<()> {
    // `cargo bench` passes this argument; without it, this only checks that the benchmark runs.
    let is_measured = std::env::args().any(|argument| argument == "--bench");
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    one.install(|| measure(is_measured))
}

fn measure(is_measured: bool) -> Result<()> {
    let mut out = std::io::stdout().lock();
    let model = Ddl::builtin(BuiltinModel::default(), DeviceChoice::Cpu)?;
    let service = |batch| queue::service(&model, batch, if is_measured { 160 } else { batch });
    let (alone, in_batch) = (service(1)?, service(BATCH)?);
    writeln!(
        out,
        "a camera takes {:.2} ms alone and {:.2} ms in a batch of {BATCH}\n\n\
         | cameras | busy, % | p50, ms | p99, ms | dropped, % |\n|---:|---:|---:|---:|---:|",
        1e3 * alone,
        1e3 * in_batch
    )?;
    let twice = (2.0 * FRAME / alone).round() as usize;
    let counts = if is_measured {
        [&CAMERAS[..], &[twice]].concat()
    } else {
        vec![1, 3]
    };
    for cameras in counts {
        let frames = if is_measured {
            (FRAMES / cameras).max(FRAMES_EACH)
        } else {
            2
        };
        let figures = queue::simulated(&model, cameras, frames)?;
        writeln!(
            out,
            "| {cameras} | {:.0} | {:.1} | {:.1} | {:.1} |",
            100.0 * figures.busy,
            1e3 * figures.latency(0.5),
            1e3 * figures.latency(0.99),
            100.0 * figures.dropped_share,
        )?;
    }
    let [tracks, waiting] = queue::memory(if is_measured { 1_000 } else { 2 })?;
    writeln!(
        out,
        "\nmemory of a camera: {tracks:.1} KiB, and {waiting:.1} KiB while a frame waits ({PEDESTRIANS} pedestrians)"
    )?;
    Ok(())
}
