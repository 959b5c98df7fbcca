//! Replays recorded tracks as a live stream: `live RUN TRACKS.csv [FRAME_STEP]` pushes one frame after the other. It
//! prints the position of each pedestrian in 4.8 s, whether the forecast approaches its goal at every step, and the
//! time it took.

use ddl::data::{Format, HORIZON, read_recording};
use ddl::{Ddl, DeviceChoice, LiveForecaster};
use std::error::Error;
use std::io::Write as _;
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (run, file, step) = match arguments.as_slice() {
        [run, file] => (run, file, None),
        [run, file, step] => (run, file, Some(step.parse()?)),
        _ => return Err("usage: live RUN TRACKS.csv [FRAME_STEP]".into()),
    };
    ddl::prepare(DeviceChoice::Cpu, Some(1))?;
    let recording = read_recording(Path::new(file), Format::Table)?;
    let step = step.unwrap_or(recording.frame_step());
    let model = Ddl::load(Path::new(run), DeviceChoice::Cpu)?;
    let mut live = LiveForecaster::with_frame_step(model, step)?;
    let mut out = std::io::stdout().lock();
    for &frame in recording.frames() {
        let people = recording.at(frame).iter();
        let started = Instant::now();
        let now = live.push_certified(frame, people.map(|seen| (seen.pedestrian, seen.position)))?;
        let took = started.elapsed().as_secs_f64() * 1e3;
        let Some(now) = now else {
            let tracked = live.tracks().len();
            writeln!(
                out,
                "frame {frame}: {tracked} pedestrians, none observed at 8 steps yet"
            )?;
            continue;
        };
        writeln!(out, "frame {frame}: forecast in {took:.1} ms")?;
        let forecast = &now.forecast.forecast;
        for (i, pedestrian) in now.window.pedestrians().iter().enumerate() {
            let k = forecast.representative(i);
            let [x, y] = forecast.hypothesis(i, k)[HORIZON - 1];
            let certificate = now.forecast.certificate(i, k);
            let verdict = match certificate.verify() {
                Ok(()) => "closer to its goal at every step".to_owned(),
                Err(violation) => violation.to_string(),
            };
            writeln!(
                out,
                "  pedestrian {pedestrian}: ({x:.2}, {y:.2}) m in 4.8 s, weight {:.2}; {verdict}",
                forecast.weight(i, k)
            )?;
        }
    }
    Ok(())
}
