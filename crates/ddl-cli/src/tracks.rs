//! A user's own tracks, and where the forecasts of them go.

use anyhow::{Context as _, bail};
use clap::Args;
use ddl::data::{Format, Recording, TIME_STEP, Window, parse_recording};
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

/// Which tracks to read.
#[derive(Debug, Args)]
pub(crate) struct Tracks {
    /// csv with the header frame,pedestrian,x,y: metres, one row each 0.4 s
    ///
    /// Or TrajNet++ ndjson, ETH obsmat.txt or the files of a data convention, told by extension and first lines.
    #[arg(value_name = "TRACKS")]
    file: PathBuf,
    /// Raw frames between two rows of a pedestrian [default: the most common difference]
    #[arg(long, requires = "file")]
    frame_step: Option<i64>,
    /// Only the last frame of the file, with those who are in it, instead of every frame with 8 observed ones behind it
    #[arg(long, requires = "file")]
    last: bool,
}

impl Tracks {
    /// The tracks, in the format that their file looks like. It is read once, so that it may be a pipe.
    fn recording(&self) -> anyhow::Result<Recording> {
        let bytes = std::fs::read(&self.file)
            .with_context(|| format!("cannot read {}", self.file.display()))?;
        let format = Format::guess(&self.file, &bytes);
        let name = self.file.file_stem().unwrap_or_default().to_string_lossy();
        let recording = parse_recording(&bytes, &self.file.display().to_string(), format)?;
        Ok(recording.with_name(&*name))
    }

    /// Windows of 8 observed frames, one a frame that has anybody to forecast.
    pub(crate) fn windows(&self) -> anyhow::Result<Vec<Window>> {
        let mut recording = self.recording()?;
        if let Some(step) = self.frame_step {
            recording = recording.with_frame_step(step)?;
        }
        let mut windows = recording.observed_windows();
        if windows.is_empty() {
            bail!(
                "{}: nobody was observed for 8 frames in a row (frame step {}); a forecast needs \
                 3.2 s of track; give --frame-step when the rows are further apart",
                self.file.display(),
                recording.frame_step()
            );
        }
        warn_of_implausible_speed(&windows);
        if self.last {
            windows.drain(..windows.len() - 1);
        }
        Ok(windows)
    }
}

/// Faster than anybody walks, in m/s.
const IMPLAUSIBLE_SPEED: f64 = 4.0;

/// Wrong units or a wrong rate give forecasts that look confident and mean nothing.
fn warn_of_implausible_speed(windows: &[Window]) {
    let mut speeds: Vec<f64> = windows
        .iter()
        .flat_map(|window| (0..window.len()).map(|i| window.observed(i)))
        .flat_map(|track| track.windows(2))
        .map(|step| (step[1][0] - step[0][0]).hypot(step[1][1] - step[0][1]) / TIME_STEP)
        .collect();
    speeds.sort_by(f64::total_cmp);
    let median = speeds.get(speeds.len() / 2).copied().unwrap_or(0.0);
    if median > IMPLAUSIBLE_SPEED {
        eprintln!(
            "warning: half of the steps are faster than {median:.1} m/s; are the positions in metres, \
             and the rows of a pedestrian 0.4 s apart?"
        );
    }
}

/// Writes a whole output: to standard output, or to a file under a temporary name that is renamed.
pub(crate) fn write_output(path: Option<&Path>, text: &str) -> anyhow::Result<()> {
    match path {
        // A device or a pipe is written to, not replaced.
        Some(path) if path.exists() && !path.is_file() => std::fs::write(path, text)
            .with_context(|| format!("cannot write to {}", path.display())),
        Some(path) => Ok(ddl::write_atomically(path, text.as_bytes())?),
        None => match std::io::stdout().lock().write_all(text.as_bytes()) {
            // whoever reads has seen enough, as in `ddl forecast .. | head`
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
            result => result.context("cannot write to standard output"),
        },
    }
}
