//! What C costs: the same forecasts by the shared library and by the crate, in turns in one process.
//!
//! `cargo xtask c --prefix DIR`, then `DDL_C_LIBRARY=DIR/lib/libddl.so cargo bench -p ddl-c`. A forecast is of
//! 25 pedestrians with 20 hypotheses each, on one thread. The crate takes its memory from malloc, the library from its
//! pool. With a number the benchmark fails if C takes that many times as long: `-- 1.02`.
#![allow(unsafe_code, reason = "a shared library")]

use ddl::data::{PedestrianId, Position, Window};
use ddl::{BuiltinModel, Ddl, DeviceChoice, Forecaster as _};
use libloading::Library;
use rustix::time::{ClockId, clock_gettime};
use std::error::Error;
use std::ffi::{c_char, c_void};
use std::hint::black_box;
use std::ptr;

const PEDESTRIANS: usize = 25;
const TURNS: usize = 301;

type Open = unsafe extern "C" fn(*const c_char, usize, *mut *mut c_void) -> u32;
type New = unsafe extern "C" fn() -> *mut c_void;
type Forecast = unsafe extern "C" fn(*const c_void, *const Position, usize, *const c_void, *mut c_void) -> u32;

fn main() -> Result<(), Box<dyn Error>> {
    let most = std::env::args().find_map(|argument| argument.parse::<f64>().ok());
    let Some(path) = std::env::var_os("DDL_C_LIBRARY") else {
        eprintln!("nothing is measured: DDL_C_LIBRARY names no library");
        return Ok(());
    };
    // On the calling thread, as the library.
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global()?;
    let tracks: Vec<Vec<Position>> = (0..PEDESTRIANS).map(track).collect();
    let flat = tracks.concat();
    let ids = (0..PEDESTRIANS as i64).map(PedestrianId).collect();
    let window = Window::new("crowd", 0, 1, ids, tracks)?;
    let model = Ddl::builtin(BuiltinModel::World, DeviceChoice::Cpu)?;
    // SAFETY: the functions of this library have these types, its handles stay until the end of the program.
    let mut from_c = unsafe {
        let library = Box::leak(Box::new(Library::new(path)?));
        let open = library.get::<Open>(b"ddl_model_open")?;
        let forecast = library.get::<Forecast>(b"ddl_model_forecast")?;
        let place = library.get::<New>(b"ddl_forecast_new")?();
        let mut opened = ptr::null_mut();
        assert_eq!(open(c"world".as_ptr(), 1, &raw mut opened), 0);
        move || assert_eq!(forecast(opened, flat.as_ptr(), PEDESTRIANS, ptr::null(), place), 0)
    };
    let mut from_rust = || drop(black_box(model.forecast_all(std::slice::from_ref(&window))));
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..TURNS {
        times[0].push(seconds(&mut from_rust));
        times[1].push(seconds(&mut from_c));
    }
    let [rust, c] = times.map(median);
    let ratio = c / rust;
    let [rust, c] = [rust, c].map(|seconds| 1e3 * seconds);
    eprintln!("Rust {rust:.3} ms, C {c:.3} ms of processor time: {ratio:.3}");
    match most {
        Some(most) if ratio > most => Err(format!("C takes {ratio:.3} times as long, more than {most}").into()),
        _ => Ok(()),
    }
}

/// Five rows of people who walk in different directions.
fn track(i: usize) -> Vec<Position> {
    let [x, y, angle] = [3.0 * (i % 5) as f64, 2.0 * (i / 5) as f64, i as f64];
    (0..8).map(|t| 0.5 * f64::from(t)).map(|d| [x + d * angle.cos(), y + d * angle.sin()]).collect()
}

fn seconds(work: &mut impl FnMut()) -> f64 {
    let now = || {
        let time = clock_gettime(ClockId::ProcessCPUTime);
        time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
    };
    let start = now();
    work();
    now() - start
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}
