//! The cost of a forecast: `cargo bench -p ddl-forecast --bench latency`; with `--features torch` also that of a
//! training step.
//!
//! A forecast is of 25 simulated pedestrians with 20 hypotheses each by a built-in model. A training step is of
//! 261 pedestrians with initial weights. The results are medians of several turns, each with empty caches: processor
//! time for one thread, wall-clock time for two.
//!
//! `cargo bench -p ddl-forecast --bench latency -- crowd` measures forecasts of 1 to 20,000 pedestrians instead,
//! `-- crowd 100 400` only these numbers of pedestrians, and `-- crowd one 100000` only with one hypothesis each. With
//! `cuda` (and `--features torch`) forecasts and training steps are measured on a card, by the wall clock and with all
//! threads.

mod clock;
mod crowd;
mod scene;
#[cfg(feature = "torch")]
mod step;

use clock::{MeasuredTime, side_by_side};
use crowd::Crowds;
use ddl::data::{Dataset, Window};
use ddl::memory::SceneMemory;
use ddl::{BuiltinModel, Ddl, DeviceChoice, Forecaster as _};
use std::error::Error;
use std::io::Write as _;

type Result<T> = std::result::Result<T, Box<dyn Error + Send + Sync>>;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let given = |name: &str| arguments.iter().any(|argument| argument == name);
    // `cargo bench` passes this argument; `cargo test` only checks that the benchmark runs.
    let is_measured = given("--bench");
    let device = if given("cuda") {
        DeviceChoice::Cuda
    } else {
        DeviceChoice::Cpu
    };
    ddl::prepare(device, None)?;
    if given("crowd") || !is_measured {
        let mut sizes: Vec<usize> = arguments.iter().filter_map(|it| it.parse().ok()).collect();
        if sizes.is_empty() {
            sizes.extend(&CROWDS[..if is_measured { CROWDS.len() } else { 3 }]);
        }
        let measured = Crowds {
            device,
            only_one: given("one"),
        };
        match device {
            DeviceChoice::Cuda => measured.measure(&sizes)?,
            _ => one_thread()?.install(|| measured.measure(&sizes))?,
        }
        if is_measured {
            return Ok(());
        }
    }
    let turns = if is_measured { 21 } else { 1 };
    let dataset = Dataset::simulated(1);
    let mut out = std::io::stdout().lock();
    #[cfg(feature = "torch")]
    if device == DeviceChoice::Cuda {
        writeln!(out, "{}", step::measured(&dataset, None, turns)?)?;
        return Ok(());
    }
    let window = scene::of(&dataset)?;
    let memory = memory_of(&dataset, if turns > 1 { FULL } else { 1 })?;
    let forecasts = one_thread()?.install(|| forecast(&window, &memory, turns))?;
    writeln!(out, "\n{forecasts}")?;
    #[cfg(feature = "torch")]
    for threads in [1, 2] {
        writeln!(out, "{}", step::measured(&dataset, Some(threads), turns)?)?;
    }
    Ok(())
}

fn one_thread() -> Result<rayon::ThreadPool> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(1).build()?)
}

const CROWDS: [usize; 9] = [1, 10, 25, 100, 400, 1_600, 5_000, 10_000, 20_000];

/// Number of segments in a memory that is almost full.
const FULL: usize = SceneMemory::DEFAULT_CAPACITY * 9 / 10;

/// A memory of all simulated scenes, filled with other simulated crowds up to this number of segments.
fn memory_of(dataset: &Dataset, segments: usize) -> Result<SceneMemory> {
    let step = dataset.recordings()[0].frame_step();
    let mut memory = SceneMemory::new(step, SceneMemory::DEFAULT_CAPACITY)?;
    let mut seed = 2;
    let mut crowds = dataset.clone();
    loop {
        for recording in crowds.recordings() {
            memory.observe_recording(recording)?;
        }
        if memory.segments() >= segments {
            return Ok(memory);
        }
        crowds = Dataset::simulated(seed);
        seed += 1;
    }
}

/// The time of a whole forecast and of its parts.
fn forecast(window: &Window, memory: &SceneMemory, turns: usize) -> Result<String> {
    let model = Ddl::builtin(BuiltinModel::default(), DeviceChoice::Cpu)?;
    let with_transformer = Ddl::builtin(BuiltinModel::Hotel, DeviceChoice::Cpu)?;
    let windows = std::slice::from_ref(window);
    let count = model.goal_model().recalled_per_pedestrian()?;
    let remembering = || memory.recalling(window.clone(), count);
    let parts: [&mut dyn FnMut() -> Result<()>; 5] = [
        &mut || Ok(model.forecast(&remembering()).map(drop)?),
        &mut || Ok(model.forecast(window).map(drop)?),
        &mut || Ok(model.goal_model().goals(windows).map(drop)?),
        &mut || Ok(model.forecast_central(windows).map(drop)?),
        &mut || Ok(with_transformer.forecast(window).map(drop)?),
    ];
    let times = side_by_side(MeasuredTime::Processor, turns, parts)?;
    let [with_memory, whole, goals, one, transformer] = times.map(|seconds| 1e3 * seconds);
    Ok(format!(
        "{} pedestrians, 20 hypotheses, one thread, processor time\n\
         whole forecast                                 {whole:>6.2} ms\n\
         its goals                                      {goals:>6.2} ms\n\
         one hypothesis                                 {one:>6.2} ms\n\
         model hotel, whose network is the Transformer  {transformer:>6.2} ms\n\
         whole forecast with a memory of {segments} segments {with_memory:>6.2} ms",
        window.len(),
        segments = memory.segments(),
    ))
}
