//! Draws a model's forecast of one test window of the scene that it was trained without.
//!
//! `draw_forecast RUN PEDESTRIANS FILE.svg` takes the window of exactly this many pedestrians in which the slowest
//! walks furthest.

use ddl::data::{Convention, Dataset, Window, WindowRule, locate};
use ddl::report::figure;
use ddl::{Ddl, DeviceChoice, Forecaster as _};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [run, pedestrians, file] = arguments.as_slice() else {
        return Err("usage: draw_forecast RUN PEDESTRIANS FILE.svg".into());
    };
    let pedestrians: usize = pedestrians.parse()?;
    let model = Ddl::load(Path::new(run), DeviceChoice::Cpu)?;
    let data = &model.config().data;
    let dataset = match data.convention {
        Convention::Simulated => Dataset::simulated(1),
        recorded => Dataset::load(recorded, &locate(recorded, None)?)?,
    };
    let windows = dataset.fold(&data.fold)?.test_windows(WindowRule::Complete);
    let window = windows
        .iter()
        .filter(|window| window.len() == pedestrians)
        .max_by(|one, other| walked(one).total_cmp(&walked(other)))
        .ok_or("no test window has exactly this many pedestrians")?;
    let forecast = model.forecast(&window.without_future())?;
    std::fs::write(file, figure::scene(window, &forecast)?)?;
    Ok(())
}

/// Length of the shortest observed path, metres.
fn walked(window: &Window) -> f64 {
    let length = |track: &[[f64; 2]]| -> f64 {
        track
            .windows(2)
            .map(|step| (step[1][0] - step[0][0]).hypot(step[1][1] - step[0][1]))
            .sum()
    };
    (0..window.len())
        .map(|i| length(window.track(i)))
        .fold(f64::INFINITY, f64::min)
}
