//! The cost of a forecast as a function of the number of pedestrians, at constant density.

use crate::Result;
use crate::clock::MeasuredTime;
use ddl::data::{OBSERVED, PedestrianId, Position, TIME_STEP, Window};
use ddl::{BuiltinModel, Ddl, DeviceChoice, Forecast, ForecastError, Forecaster, LiveForecaster};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use std::io::Write as _;
use std::{fs, iter};

/// Pedestrians per square metre, about as many as in the recording `students003`.
const DENSITY: f64 = 0.2;
/// Noise of a position from frame to frame (metres).
const JITTER: f64 = 0.01;

/// What is measured.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crowds {
    /// On the CPU processor time is measured, on a card the time by the wall clock.
    pub(crate) device: DeviceChoice,
    /// Only one hypothesis for each pedestrian.
    pub(crate) only_one: bool,
}

impl Crowds {
    /// Prints one row for each number of pedestrians: seconds, and the peak memory of the process.
    pub(crate) fn measure(self, sizes: &[usize]) -> Result<()> {
        let model = Ddl::builtin(BuiltinModel::default(), self.device)?;
        let clock = match self.device {
            DeviceChoice::Cuda => MeasuredTime::Wall,
            _ => MeasuredTime::Processor,
        };
        let mut out = std::io::stdout().lock();
        writeln!(
            out,
            "{DENSITY} pedestrians per square metre, {clock:?} time, threads: {}\n\
             pedestrians | 20 hypotheses, s | ms a pedestrian | one, s | a live frame, one, s | MiB at most",
            rayon::current_num_threads()
        )?;
        for &pedestrians in sizes {
            let window = crowd(pedestrians)?;
            let of_hypotheses = if self.only_one {
                f64::NAN
            } else {
                seconds(clock, pedestrians, || Ok(model.forecast(&window).map(drop)?))?
            };
            let of_one = seconds(clock, pedestrians, || Ok(One(&model).forecast(&window).map(drop)?))?;
            let frame = live_frame(clock, &model, &window)?;
            writeln!(
                out,
                "{pedestrians} | {of_hypotheses:.4} | {:.3} | {of_one:.4} | {frame:.4} | {}",
                1e3 * of_hypotheses / pedestrians as f64,
                most_memory()?
            )?;
        }
        Ok(())
    }
}

/// Pedestrians at random positions in a square. Each walks in a straight line at its own speed.
fn crowd(pedestrians: usize) -> Result<Window> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let side = (pedestrians as f64 / DENSITY).sqrt();
    let mut tracks = iter::repeat_with(|| {
        let start = [0; 2].map(|_| side * random.random::<f64>());
        let (speed, heading) = (random.random_range(0.5..1.8), TAU * random.random::<f64>());
        let velocity = [speed * f64::cos(heading), speed * f64::sin(heading)];
        let position = |t: usize| -> Position {
            std::array::from_fn(|axis| {
                let jitter = JITTER * (random.random::<f64>() - 0.5);
                start[axis] + velocity[axis] * TIME_STEP * t as f64 + jitter
            })
        };
        (0..OBSERVED).map(position).collect()
    });
    let ids = (0..pedestrians).map(|i| PedestrianId(i as i64));
    let tracks: Vec<Vec<Position>> = tracks.by_ref().take(pedestrians).collect();
    Ok(Window::new("crowd", 0, 1, ids.collect(), tracks)?)
}

/// Only the central forecast.
#[derive(Debug, Clone, Copy)]
struct One<'a>(&'a Ddl);

impl Forecaster for One<'_> {
    fn name(&self) -> String {
        self.0.name()
    }

    fn forecast(&self, window: &Window) -> std::result::Result<Forecast, ForecastError> {
        let mut forecasts = self.0.forecast_central(std::slice::from_ref(window))?;
        Ok(forecasts.remove(0))
    }
}

/// Seconds to push the eighth frame of a stream, the first with a forecast for all pedestrians.
fn live_frame(clock: MeasuredTime, model: &Ddl, window: &Window) -> Result<f64> {
    let mut live = LiveForecaster::new(One(model));
    let frame = |t: usize| {
        let pedestrians = window.pedestrians().iter().enumerate();
        pedestrians.map(move |(i, &pedestrian)| (pedestrian, window.observed(i)[t]))
    };
    let last = OBSERVED - 1;
    for t in 0..last {
        live.push(t as i64, frame(t))?;
    }
    seconds(clock, window.len(), || {
        Ok(live.clone().push(last as i64, frame(last)).map(drop)?)
    })
}

/// Time of the work, the minimum of three turns. A turn repeats the work of a small window until it is long
/// enough for the clock; a long turn is not repeated.
fn seconds(clock: MeasuredTime, pedestrians: usize, mut work: impl FnMut() -> Result<()>) -> Result<f64> {
    let repetitions = (400 / pedestrians).max(1);
    let mut least = f64::INFINITY;
    for _ in 0..3 {
        let spent = clock.seconds(|| (0..repetitions).try_for_each(|_| work()))?;
        least = least.min(spent / repetitions as f64);
        if spent > LONG {
            break;
        }
    }
    Ok(least)
}

/// Seconds after which a turn is not repeated.
const LONG: f64 = 2.0;

/// The peak resident memory of the process in MiB since the last call.
fn most_memory() -> Result<usize> {
    let status = fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.split_whitespace().next());
    // Writing 5 resets `VmHWM`.
    fs::write("/proc/self/clear_refs", "5")?;
    Ok(kib.ok_or("no VmHWM in /proc/self/status")?.parse::<usize>()? / 1024)
}
