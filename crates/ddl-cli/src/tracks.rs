//! A user's own tracks, and where the forecasts of them go.

use anyhow::{Context as _, bail};
use clap::Args;
use ddl::data::{
    Completion, Format, Homography, MadeUp, OBSERVED, Recording, TIME_STEP, Window,
    parse_recording, whole_frame_step,
};
use serde::Serialize;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

/// Which tracks to read, and what their numbers mean.
#[derive(Debug, Args)]
pub(crate) struct Tracks {
    /// csv with the header frame,pedestrian,x,y: metres, rows of a pedestrian 0.4 s apart unless --fps or --dt says otherwise
    ///
    /// Or TrajNet++ ndjson, ETH obsmat.txt or the files of a data convention, told by extension and first lines. `ddl forecast -` reads a tracker's lines as
    /// they come.
    #[arg(value_name = "TRACKS")]
    file: PathBuf,
    /// Frame numbers count so many a second, such as 25: steps of 0.4 s are found, and resampled where they are no whole number of frames
    #[arg(long, requires = "file", conflicts_with_all = ["dt", "frame_step"], value_parser = positive)]
    fps: Option<f64>,
    /// Seconds from one frame number to the next, such as 0.1
    #[arg(long, requires = "file", conflicts_with = "frame_step", value_name = "SECONDS", value_parser = positive)]
    dt: Option<f64>,
    /// Frame numbers in 0.4 s [default: the most common difference between two rows]
    #[arg(long, requires = "file")]
    frame_step: Option<i64>,
    /// Positions are pixels: a file of three lines of three numbers, the homography from pixels to metres
    #[arg(long, requires = "file", value_name = "FILE")]
    homography: Option<PathBuf>,
    /// Only who was seen in each of the last 8 frames
    ///
    /// Otherwise who was seen in 2 of them or more is forecast too: holes of up to 2 frames are filled on a straight line, and what begins late is
    /// padded at the mean velocity seen. The columns `padded` and `filled` count such positions.
    #[arg(long, requires = "file")]
    whole: bool,
    /// Only the last frame that can be forecast from, instead of every one
    #[arg(long, requires = "file")]
    last: bool,
}

/// What can be forecast from.
#[derive(Debug)]
pub(crate) struct Observed {
    /// One a frame that has anybody to forecast.
    pub(crate) windows: Vec<Window>,
    pub(crate) clock: Clock,
}

/// How frames of windows are numbered in the tracks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Clock {
    /// Parts of a frame that windows count.
    parts: i64,
}

/// A frame as the tracks number it; between two frames where these do not meet the steps of 0.4 s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub(crate) enum FrameNumber {
    Whole(i64),
    Between(f64),
}

impl Clock {
    /// Windows count frames as the tracks do.
    pub(crate) const WHOLE: Self = Self { parts: 1 };

    pub(crate) fn number(self, frame: i64) -> FrameNumber {
        if frame % self.parts == 0 {
            FrameNumber::Whole(frame / self.parts)
        } else {
            FrameNumber::Between(frame as f64 / self.parts as f64)
        }
    }
}

impl std::fmt::Display for FrameNumber {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Whole(frame) => frame.fmt(f),
            Self::Between(frame) => frame.fmt(f),
        }
    }
}

impl Tracks {
    /// Whether they come from standard input.
    pub(crate) fn are_live(&self) -> bool {
        self.file.as_os_str() == "-"
    }

    /// The tracks in metres, in the format that their file looks like. It is read once, so that it may be a pipe.
    fn recording(&self) -> anyhow::Result<Recording> {
        let bytes = std::fs::read(&self.file)
            .with_context(|| format!("cannot read {}", self.file.display()))?;
        let format = Format::guess(&self.file, &bytes);
        let name = self.file.file_stem().unwrap_or_default().to_string_lossy();
        let recording = parse_recording(&bytes, &self.file.display().to_string(), format)?;
        let recording = recording.with_name(&*name);
        match self.homography()? {
            None => Ok(recording),
            Some(homography) => homography
                .on_the_ground(&recording)
                .with_context(|| self.file.display().to_string()),
        }
    }

    /// From pixels to metres, where positions are pixels.
    pub(crate) fn homography(&self) -> anyhow::Result<Option<Homography>> {
        let Some(path) = &self.homography else {
            return Ok(None);
        };
        let text = std::fs::read_to_string(path)
            .with_context(|| format!("cannot read {}", path.display()))?;
        let homography = text.parse().with_context(|| path.display().to_string())?;
        Ok(Some(homography))
    }

    /// What is made up of observations that are not whole.
    pub(crate) fn completion(&self) -> Completion {
        if self.whole {
            Completion::NONE
        } else {
            Completion::USUAL
        }
    }

    /// Seconds from one frame number to the next, as far as they were given.
    fn frame_time(&self) -> Option<f64> {
        self.dt.or(self.fps.map(|fps| 1.0 / fps))
    }

    /// Frame numbers in a step of live tracks, as far as they were given.
    pub(crate) fn live_frame_step(&self) -> anyhow::Result<Option<i64>> {
        if self.last {
            bail!(
                "--last has no meaning for tracks that have no end yet: every frame of standard input is forecast from as it comes"
            );
        }
        let Some(frame_time) = self.frame_time() else {
            return Ok(self.frame_step);
        };
        let Some(step) = whole_frame_step(frame_time) else {
            bail!(
                "0.4 s are {:.4} frames: live tracks are not resampled; give a rate of which 0.4 s are a whole number of frames, or \
                 count frames in finer parts",
                TIME_STEP / frame_time
            );
        };
        Ok(Some(step))
    }

    /// The tracks in steps of 0.4 s.
    fn in_steps(&self) -> anyhow::Result<(Recording, Clock)> {
        let recording = self.recording()?;
        let Some(frame_time) = self.frame_time() else {
            let recording = match self.frame_step {
                None => recording,
                Some(step) => recording.with_frame_step(step)?,
            };
            return Ok((recording, Clock { parts: 1 }));
        };
        let steps = recording
            .in_steps(frame_time)
            .with_context(|| self.file.display().to_string())?;
        if steps.resampled {
            eprintln!(
                "note: 0.4 s are {:.4} frames: positions are taken on straight lines between frames, every 0.4 s back from the last one",
                TIME_STEP / frame_time
            );
        }
        let parts = steps.parts;
        Ok((steps.recording, Clock { parts }))
    }

    /// Windows of 8 observed frames, one a frame that has anybody to forecast.
    pub(crate) fn observed(&self) -> anyhow::Result<Observed> {
        let (recording, clock) = self.in_steps()?;
        let mut windows = recording.completed_windows(self.completion());
        if windows.is_empty() {
            bail!(
                "{}: nobody was seen {} (steps of {} frames); give --fps where frame numbers are not 0.4 s apart, or --frame-step",
                self.file.display(),
                if self.whole {
                    "for 8 frames in a row, 3.2 s"
                } else {
                    "at two frames 0.4 s apart"
                },
                clock.number(recording.frame_step())
            );
        }
        warn_of_implausible_speed(&windows);
        if self.last {
            windows.drain(..windows.len() - 1);
        }
        Ok(Observed { windows, clock })
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let number: f64 = text
        .parse()
        .map_err(|error| format!("must be a number ({error})"))?;
    if number.is_finite() && number > 0.0 {
        Ok(number)
    } else {
        Err("must be a finite number above 0".to_owned())
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
             and the rows of a pedestrian 0.4 s apart? (--homography, --fps)"
        );
    }
}

impl Observed {
    /// Says so where observations were not whole: a forecast from two positions looks like any other.
    pub(crate) fn tell_what_is_made_up(&self) {
        let windows = self.windows.iter();
        let all: Vec<MadeUp> = windows
            .flat_map(|window| (0..window.len()).map(|i| window.made_up(i)))
            .collect();
        let late = all.iter().filter(|made_up| made_up.padded > 0).count();
        let holes = all.iter().filter(|made_up| made_up.filled > 0).count();
        if late + holes > 0 {
            eprintln!(
                "note: of {} forecasts {late} are of people seen for less than {OBSERVED} frames, and {holes} over holes that were filled (columns \
                 padded and filled); --whole leaves them out",
                all.len()
            );
        }
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
