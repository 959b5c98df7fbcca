//! Draws the forecast at one frame of a recording, with the true future. This command draws the picture of the README:
//!
//! ```text
//! cargo run --release -p ddl-forecast --features report --example draw_forecast -- \
//!     datasets/sample.csv 15 docs/forecast.svg
//! ```
//! The arguments are a table of tracks, the last observed frame and the picture; then, if not the built-in model
//! `world`, a run or a packed file.

use ddl::data::{Format, OBSERVED, WindowRule, read_recording};
use ddl::report::figure;
use ddl::{BuiltinModel, Ddl, DeviceChoice, Request};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (tracks, frame, picture, model) = match arguments.as_slice() {
        [tracks, frame, picture] => (tracks, frame, picture, Ddl::builtin(BuiltinModel::default(), DeviceChoice::Cpu)?),
        [tracks, frame, picture, model] => (tracks, frame, picture, Ddl::load(Path::new(model), DeviceChoice::Cpu)?),
        _ => return Err("usage: draw_forecast TRACKS.csv FRAME PICTURE.svg [MODEL]".into()),
    };
    let recording = read_recording(Path::new(tracks), Format::Table)?;
    let frame: i64 = frame.parse()?;
    let windows = recording.windows(WindowRule::Complete);
    let window = windows
        .iter()
        .find(|window| window.frames()[OBSERVED - 1] == frame)
        .ok_or("no pedestrian was observed for 8 steps before this frame and 12 after it")?;
    let answers = model.forecast(&[window.without_future()], &Request::default())?;
    std::fs::write(picture, figure::scene(window, answers[0].forecast())?)?;
    Ok(())
}
