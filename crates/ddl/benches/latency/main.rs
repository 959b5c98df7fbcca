//! The cost of a forecast: `cargo bench -p ddl-forecast --bench latency`; with `--features torch` also that of a
//! training step.
//!
//! A forecast is of 25 simulated pedestrians with 20 hypotheses each by a built-in model. A training step is of
//! 261 pedestrians with initial weights. The results are medians of 21 runs, each with empty caches: processor
//! time for one thread, wall-clock time for two.
//!
//! `cargo bench -p ddl-forecast --bench latency -- crowd` measures forecasts of 1 to 20,000 pedestrians instead,
//! `-- crowd 100 400` only these numbers of pedestrians, and `-- crowd one 100000` only with one hypothesis each; with
//! `cuda` (and `--features torch`) on a card, by the wall clock and with all threads.

mod crowd;
#[cfg(feature = "torch")]
mod step;

use ddl::data::Dataset;
use ddl::memory::SceneMemory;
use ddl::{BuiltinModel, Ddl, DeviceChoice, Request};
use rustix::time::{ClockId, clock_gettime};
use std::error::Error;
use std::hint::black_box;

type Result<T> = std::result::Result<T, Box<dyn Error + Send + Sync>>;

const CROWDS: [usize; 9] = [1, 10, 25, 100, 400, 1_600, 5_000, 10_000, 20_000];
/// Number of segments in a memory that is almost full.
const FULL: usize = SceneMemory::DEFAULT_CAPACITY * 9 / 10;
/// Bytes written to empty the caches: more than they hold.
const CACHES: usize = 256 << 20;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let given = |name: &str| arguments.iter().any(|argument| argument == name);
    // `cargo bench` passes this argument; `cargo test` only checks that the benchmark runs.
    let is_measured = given("--bench");
    let (device, clock, threads) = if given("cuda") {
        (DeviceChoice::Cuda, ClockId::Monotonic, 0)
    } else {
        (DeviceChoice::Cpu, ClockId::ProcessCPUTime, 1)
    };
    ddl::prepare(device, None)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    if given("crowd") || !is_measured {
        let mut sizes: Vec<usize> = arguments.iter().filter_map(|it| it.parse().ok()).collect();
        if sizes.is_empty() {
            sizes.extend(&CROWDS[..if is_measured { CROWDS.len() } else { 3 }]);
        }
        pool.install(|| crowd::measure(device, clock, given("one"), &sizes))?;
    }
    if !given("crowd") {
        let (runs, segments) = if is_measured { (21, FULL) } else { (1, 1) };
        let dataset = Dataset::simulated(1);
        pool.install(|| forecasts(&dataset, segments, runs))?;
        #[cfg(feature = "torch")]
        step::measure(&dataset, runs)?;
    }
    Ok(())
}

fn seconds<T>(clock: ClockId, work: impl FnOnce() -> Result<T>) -> Result<f64> {
    let now = || {
        let time = clock_gettime(clock);
        time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
    };
    let before = now();
    work()?;
    Ok(now() - before)
}

/// Median of the runs after a first one, each with empty caches.
fn median<T>(clock: ClockId, runs: usize, mut work: impl FnMut() -> Result<T>) -> Result<f64> {
    let mut bytes = vec![0_u8; CACHES];
    work()?;
    let mut run = |_| {
        black_box(&mut bytes).fill(1);
        seconds(clock, &mut work)
    };
    let mut times = (0..runs).map(&mut run).collect::<Result<Vec<f64>>>()?;
    times.sort_by(f64::total_cmp);
    Ok(times[runs / 2])
}

/// The time of a whole forecast and of its parts.
#[expect(clippy::print_stdout, reason = "the results")]
fn forecasts(dataset: &Dataset, segments: usize, runs: usize) -> Result<()> {
    let model = Ddl::builtin(BuiltinModel::default(), DeviceChoice::Cpu)?;
    let transformer = Ddl::builtin(BuiltinModel::Hotel, DeviceChoice::Cpu)?;
    let mut windows = dataset.recordings().iter().flat_map(ddl::data::Recording::observed_windows);
    let crowded = windows.find(|window| window.len() >= 25).ok_or("no crowded scene")?;
    let window = crowded.filter_pedestrians(|i| i < 25).ok_or("nobody")?;
    let (windows, all) = (std::slice::from_ref(&window), Request::default());
    let memory = memory_of(dataset, segments)?;
    let count = model.goal_model().recalled_per_pedestrian()?;
    let show = |part: &str, work: &dyn Fn() -> Result<()>| -> Result<()> {
        let time = 1e3 * median(ClockId::ProcessCPUTime, runs, work)?;
        println!("{time:6.2} ms  {part}");
        Ok(())
    };
    println!("25 pedestrians, 20 hypotheses, one thread, processor time");
    show("whole forecast", &|| Ok(model.forecast(windows, &all).map(drop)?))?;
    show("its goals", &|| Ok(model.goal_model().goals(windows).map(drop)?))?;
    show("one hypothesis", &|| Ok(model.forecast(windows, &Request::one()).map(drop)?))?;
    show("model hotel, whose network is the Transformer", &|| Ok(transformer.forecast(windows, &all).map(drop)?))?;
    let remembering = || Ok(model.forecast(&[memory.recalling(window.clone(), count)], &all).map(drop)?);
    show(&format!("with a memory of {} segments", memory.segments()), &remembering)
}

/// A memory of all simulated scenes, filled with other simulated crowds up to this number of segments.
fn memory_of(dataset: &Dataset, segments: usize) -> Result<SceneMemory> {
    let step = dataset.recordings()[0].frame_step();
    let mut memory = SceneMemory::new(step, SceneMemory::DEFAULT_CAPACITY)?;
    for crowds in std::iter::once(dataset.clone()).chain((2..).map(Dataset::simulated)) {
        for recording in crowds.recordings() {
            memory.observe_recording(recording)?;
        }
        if memory.segments() >= segments {
            break;
        }
    }
    Ok(memory)
}
