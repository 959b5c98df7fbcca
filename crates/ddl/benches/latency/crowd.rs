//! The cost of a forecast as a function of the number of pedestrians, at constant density.

use crate::{Result, seconds};
use ddl::data::{LiveTracks, OBSERVED, PedestrianId, Position, TIME_STEP, Window};
use ddl::{BuiltinModel, Ddl, DeviceChoice, Request, Session};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rustix::time::ClockId;
use std::f64::consts::TAU;
use std::{fs, iter};

/// Pedestrians per square metre, about as many as in the recording `students003`.
const DENSITY: f64 = 0.2;
/// Noise of a position from frame to frame (metres).
const JITTER: f64 = 0.01;

/// Prints one row for each number of pedestrians: seconds, the least of three runs, and the peak memory of the process.
#[expect(clippy::print_stdout, reason = "the results")]
pub(crate) fn measure(device: DeviceChoice, clock: ClockId, only_one: bool, sizes: &[usize]) -> Result<()> {
    let model = Ddl::builtin(BuiltinModel::default(), device)?;
    let threads = rayon::current_num_threads();
    println!("{DENSITY} pedestrians per square metre, {clock:?}, threads: {threads}");
    println!("pedestrians | 20 hypotheses, s | ms a pedestrian | one, s | a live frame, one, s | MiB at most");
    for &pedestrians in sizes {
        let window = crowd(pedestrians)?;
        let windows = std::slice::from_ref(&window);
        let all = if only_one {
            f64::NAN
        } else {
            least(clock, || Ok(model.forecast(windows, &Request::default()).map(drop)?))?
        };
        let one = least(clock, || Ok(model.forecast(windows, &Request::one()).map(drop)?))?;
        let frame = live_frame(clock, &model, &window)?;
        let each = 1e3 * all / pedestrians as f64;
        println!("{pedestrians} | {all:.4} | {each:.3} | {one:.4} | {frame:.4} | {}", most_memory()?);
    }
    Ok(())
}

/// Pedestrians at random positions in a square. Each walks in a straight line at its own speed.
fn crowd(pedestrians: usize) -> Result<Window> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let side = (pedestrians as f64 / DENSITY).sqrt();
    let track = || {
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
    };
    let tracks = iter::repeat_with(track).take(pedestrians).collect();
    let ids = (0..pedestrians).map(|i| PedestrianId(i as i64)).collect();
    Ok(Window::new("crowd", 0, 1, ids, tracks)?)
}

/// Seconds to push the eighth frame of a stream, the first with a forecast for all pedestrians.
fn live_frame(clock: ClockId, model: &Ddl, window: &Window) -> Result<f64> {
    let frame = |t: usize| {
        window.pedestrians().iter().enumerate().map(move |(i, &pedestrian)| (pedestrian, window.observed(i)[t]))
    };
    let mut least = f64::INFINITY;
    for _ in 0..3 {
        let mut session = Session::new(model, LiveTracks::new(), Request::one())?;
        for t in 0..OBSERVED - 1 {
            session.push(t as i64, frame(t))?;
        }
        let last = OBSERVED - 1;
        least = least.min(seconds(clock, || Ok(session.push(last as i64, frame(last)).map(drop)?))?);
    }
    Ok(least)
}

fn least(clock: ClockId, work: impl Fn() -> Result<()>) -> Result<f64> {
    (0..3).try_fold(f64::INFINITY, |least, _| Ok(seconds(clock, &work)?.min(least)))
}

/// The peak resident memory of the process in MiB since the last call.
fn most_memory() -> Result<usize> {
    let status = fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.split_whitespace().next());
    // Writing 5 resets `VmHWM`.
    fs::write("/proc/self/clear_refs", "5")?;
    Ok(kib.ok_or("no VmHWM in /proc/self/status")?.parse::<usize>()? / 1024)
}
