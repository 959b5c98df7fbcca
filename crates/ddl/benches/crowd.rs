//! What a forecast costs by the number of pedestrians at a constant density, `cargo bench -p ddl --bench crowd`:
//! processor time of one thread and the memory the process needs at most.
//!
//! `cargo bench -p ddl --bench crowd -- 100 400` measures these numbers of pedestrians alone.

use ddl::data::{OBSERVED, PedestrianId, Position, TIME_STEP, Window};
use ddl::eval::{Forecast, ForecastError};
use ddl::{BuiltinModel, Ddl, DeviceChoice, Forecaster, LiveForecaster};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rustix::time::{ClockId, clock_gettime};
use std::error::Error;
use std::f64::consts::TAU;
use std::io::Write as _;
use std::{fs, iter};

type Result<T> = std::result::Result<T, Box<dyn Error + Send + Sync>>;

/// Pedestrians in a square metre, about as many as in the recording `students003`.
const DENSITY: f64 = 0.2;
/// Metres that a place jitters by from frame to frame.
const JITTER: f64 = 0.01;
const SIZES: [usize; 9] = [1, 10, 25, 100, 400, 1_600, 5_000, 10_000, 20_000];

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let named = arguments
        .iter()
        .filter_map(|argument| argument.parse().ok());
    let mut sizes: Vec<usize> = named.collect();
    if sizes.is_empty() {
        // `cargo bench` passes this argument; `cargo test` only checks that the benchmark runs.
        let all = arguments.iter().any(|argument| argument == "--bench");
        sizes = SIZES[..if all { SIZES.len() } else { 3 }].to_vec();
    }
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    one.install(|| measure(&sizes))
}

fn measure(sizes: &[usize]) -> Result<()> {
    let model = Ddl::builtin(BuiltinModel::Hotel, DeviceChoice::Cpu)?;
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "{DENSITY} pedestrians in a square metre, one thread, processor time\n\
         pedestrians | 20 hypotheses, s | ms a pedestrian | one, s | a live frame, one, s | MiB at most"
    )?;
    for &pedestrians in sizes {
        let window = crowd(pedestrians)?;
        // Small crowds are forecast several times, so that a turn is long enough for the clock.
        let repetitions = (400 / pedestrians).max(1);
        let of_hypotheses = seconds(repetitions, || Ok(model.forecast(&window).map(drop)?))?;
        let of_one = seconds(repetitions, || {
            Ok(model
                .forecast_one(std::slice::from_ref(&window))
                .map(drop)?)
        })?;
        let frame = live_frame(&model, &window)?;
        writeln!(
            out,
            "{pedestrians} | {of_hypotheses:.4} | {:.3} | {of_one:.4} | {frame:.4} | {}",
            1e3 * of_hypotheses / pedestrians as f64,
            most_memory()?
        )?;
        out.flush()?;
    }
    Ok(())
}

/// Pedestrians at random places of a square, each walking straight on at its own speed.
fn crowd(pedestrians: usize) -> Result<Window> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let side = (pedestrians as f64 / DENSITY).sqrt();
    let mut tracks = iter::repeat_with(|| {
        let start = [0; 2].map(|_| side * random.random::<f64>());
        let (speed, heading) = (random.random_range(0.5..1.8), TAU * random.random::<f64>());
        let velocity = [speed * f64::cos(heading), speed * f64::sin(heading)];
        let at = |t: usize| -> Position {
            std::array::from_fn(|axis| {
                let jitter = JITTER * (random.random::<f64>() - 0.5);
                start[axis] + velocity[axis] * TIME_STEP * t as f64 + jitter
            })
        };
        (0..OBSERVED).map(at).collect()
    });
    let ids = (0..pedestrians).map(|i| PedestrianId(i as i64));
    let tracks: Vec<Vec<Position>> = tracks.by_ref().take(pedestrians).collect();
    Ok(Window::new("crowd", 0, 1, ids.collect(), tracks)?)
}

/// The central forecast alone.
#[derive(Debug, Clone, Copy)]
struct One<'a>(&'a Ddl);

impl Forecaster for One<'_> {
    fn name(&self) -> String {
        self.0.name()
    }

    fn forecast(&self, window: &Window) -> std::result::Result<Forecast, ForecastError> {
        // One window in, one forecast out.
        let mut forecasts = self.0.forecast_one(std::slice::from_ref(window))?;
        Ok(forecasts.remove(0))
    }
}

/// Seconds of the frame of a stream from which everybody is forecast.
fn live_frame(model: &Ddl, window: &Window) -> Result<f64> {
    let mut live = LiveForecaster::new(One(model));
    let frame = |t: usize| {
        let everybody = window.pedestrians().iter().enumerate();
        everybody.map(move |(i, &pedestrian)| (pedestrian, window.observed(i)[t]))
    };
    for t in 0..OBSERVED - 1 {
        live.push(t as i64, frame(t))?;
    }
    let last = OBSERVED - 1;
    seconds(1, || {
        Ok(live.clone().push(last as i64, frame(last)).map(drop)?)
    })
}

/// Processor time of one of the repetitions, the quickest of three turns where they are short.
fn seconds(repetitions: usize, mut work: impl FnMut() -> Result<()>) -> Result<f64> {
    let mut least = f64::INFINITY;
    for _ in 0..3 {
        let start = processor_time();
        for _ in 0..repetitions {
            work()?;
        }
        let spent = processor_time() - start;
        least = least.min(spent / repetitions as f64);
        if spent > LONG {
            break;
        }
    }
    Ok(least)
}

/// Seconds after which a turn is not repeated.
const LONG: f64 = 2.0;

fn processor_time() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// MiB that the process has had resident at most since the last call.
fn most_memory() -> Result<usize> {
    let status = fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.split_whitespace().next());
    // A 5 resets what `VmHWM` counts from.
    fs::write("/proc/self/clear_refs", "5")?;
    Ok(kib
        .ok_or("no VmHWM in /proc/self/status")?
        .parse::<usize>()?
        / 1024)
}
