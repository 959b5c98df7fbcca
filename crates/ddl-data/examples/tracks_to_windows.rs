//! Reads tracks of any format and cuts the windows for forecasts.
//!
//! ```text
//! cargo run -p ddl-data --example tracks_to_windows
//! cargo run -p ddl-data --example tracks_to_windows -- tracks.csv 25
//! ```
//! The arguments are a file, whose format is recognised by its name and first lines, and its number of frames per
//! second. Without arguments, three simulated pedestrians are written in two formats. One of them arrives late, one is
//! lost for a moment.
#![expect(clippy::print_stdout, reason = "the example prints its result")]

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;

use ddl_data::{Completion, Format, OBSERVED, WindowRule, parse_recording};

/// Rows of frame, pedestrian, x and y (m), every 10th frame of a camera at 25 frames per second: 0.4 s apart.
fn three_pedestrians() -> Vec<(i64, i64, f64, f64)> {
    let mut rows = Vec::new();
    for step in 0..24 {
        let (frame, t) = (10 * step, 0.4 * step as f64);
        rows.push((frame, 1, 1.3 * t, 0.0));
        // The tracker loses this pedestrian for two steps.
        if !(18..20).contains(&step) {
            rows.push((frame, 2, 12.0 - 1.1 * t, 0.8));
        }
        // This pedestrian comes around the corner at the end.
        if step >= 20 {
            rows.push((frame, 3, 4.0, -3.0 + 0.9 * (t - 8.0)));
        }
    }
    rows
}

fn written(rows: &[(i64, i64, f64, f64)]) -> [(&'static str, String); 2] {
    let mut table = "frame,pedestrian,x,y\n".to_owned();
    let mut lines = String::new();
    for (frame, pedestrian, x, y) in rows {
        // Writing to a string cannot fail.
        let _ = writeln!(table, "{frame},{pedestrian},{x:.3},{y:.3}");
        let _ = writeln!(
            lines,
            r#"{{"track": {{"f": {frame}, "p": {pedestrian}, "x": {x:.3}, "y": {y:.3}}}}}"#
        );
    }
    [("street.csv", table), ("street.ndjson", lines)]
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [] => {
            for (file, text) in written(&three_pedestrians()) {
                show(Path::new(file), text.as_bytes(), 25.0)?;
            }
            Ok(())
        }
        [file, rate] => {
            let bytes = std::fs::read(file).map_err(|error| format!("{file}: {error}"))?;
            show(Path::new(file), &bytes, rate.parse()?)
        }
        _ => Err("usage: tracks_to_windows [FILE FRAMES_A_SECOND]".into()),
    }
}

fn show(file: &Path, bytes: &[u8], frames_a_second: f64) -> Result<(), Box<dyn Error>> {
    let format = Format::guess(file, bytes);
    let recording = parse_recording(bytes, &file.display().to_string(), format)?;
    let recording = recording.resampled_to_steps(1.0 / frames_a_second)?.recording;
    println!(
        "{}: format {format}, {} positions of {} pedestrians, {} frames per step of 0.4 s",
        recording.name(),
        recording.observations().len(),
        recording.pedestrians().len(),
        recording.frame_step()
    );
    println!(
        "  {} windows with a known future, for training and evaluation",
        recording.windows(WindowRule::Complete).len()
    );
    let windows = recording.completed_windows(Completion::DEFAULT);
    let Some(last) = windows.last() else {
        println!("  no pedestrian can be forecast");
        return Ok(());
    };
    println!(
        "  {} windows to forecast from; the last, up to frame {}:",
        windows.len(),
        last.frames()[OBSERVED - 1]
    );
    for (i, pedestrian) in last.pedestrians().iter().enumerate() {
        let ([x, y], counts) = (last.observed(i)[OBSERVED - 1], last.completion_counts(i));
        println!(
            "    pedestrian {pedestrian} at ({x:.2}, {y:.2}) m; of 8 positions {} observed, {} filled in, {} padded \
             at the start",
            counts.seen(),
            counts.filled,
            counts.padded
        );
    }
    Ok(())
}
