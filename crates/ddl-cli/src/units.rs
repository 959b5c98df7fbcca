//! What the numbers of tracks mean: how fast frames follow each other, and where a pixel is.

use crate::clock::Clock;
use crate::output::shell_word;
use crate::telling::tell;
use anyhow::{Context as _, bail};
use clap::Args;
use ddl::data::{Format, Homography, Recording, TIME_STEP, parse_recording, whole_frame_step};
use ddl::{RunConfig, TrackUnits};
use std::path::{Path, PathBuf};

/// What frame numbers and positions mean.
#[derive(Debug, Clone, Args)]
pub(crate) struct Units {
    /// Frame numbers count so many a second, such as 25: steps of 0.4 s are found, and resampled where they are no whole number of frames [default: the
    /// rate that scenes of TrajNet++ files say]
    #[arg(long, conflicts_with_all = ["dt", "frame_step"], value_parser = positive)]
    fps: Option<f64>,
    /// Seconds from one frame number to the next, such as 0.1
    #[arg(long, conflicts_with = "frame_step", value_name = "SECONDS", value_parser = positive)]
    dt: Option<f64>,
    /// Frame numbers in 0.4 s [default: the most common difference between two rows]
    #[arg(long, value_parser = clap::value_parser!(i64).range(1..=1 << 31))]
    frame_step: Option<i64>,
    /// Positions are pixels: a file of three lines of three numbers, the homography from pixels to metres
    #[arg(long, value_name = "FILE")]
    homography: Option<PathBuf>,
    /// The homography that a run remembers.
    #[arg(skip)]
    remembered: Option<Homography>,
}

/// A recording in steps of 0.4 s.
#[derive(Debug)]
pub(crate) struct InSteps {
    pub(crate) recording: Recording,
    pub(crate) clock: Clock,
    /// What was found out about its rate, for [`tell_notes`](crate::recordings::tell_notes).
    pub(crate) notes: Vec<String>,
}

/// Rates are one where they differ by no more than this share.
const SAME: f64 = 0.005;

impl Units {
    /// The same; where nothing else is said, as a run on own recordings was told in training, and that is told.
    pub(crate) fn or_those_of(&self, run: &RunConfig) -> Self {
        let mut units = self.clone();
        let Some(told) = run.units else {
            return units;
        };
        let mut taken = String::new();
        if !self.say_the_rate() {
            (units.fps, units.dt, units.frame_step) = (told.fps, told.dt, told.frame_step);
            taken += &units.rate_options();
        }
        if self.homography.is_none() && told.homography.is_some() {
            units.remembered = told.homography;
            taken += " and its homography";
        }
        let taken = taken.trim_start().trim_start_matches("and ");
        if !taken.is_empty() {
            tell(format_args!(
                "note: the recordings are read as the run's were: {taken}; options say otherwise"
            ));
        }
        units
    }

    /// What a run remembers of them; nothing where nothing was given.
    pub(crate) fn told(&self) -> anyhow::Result<Option<TrackUnits>> {
        let told = TrackUnits {
            fps: self.fps,
            dt: self.dt,
            frame_step: self.frame_step,
            homography: self.homography()?,
        };
        Ok(self.are_given().then_some(told))
    }

    /// Whether any of them was given.
    pub(crate) fn are_given(&self) -> bool {
        self.say_the_rate() || self.homography.is_some()
    }

    /// What another command takes for the same.
    pub(crate) fn as_options(&self) -> String {
        let homography = self.homography.as_ref();
        let homography = homography.map(|file| format!(" --homography {}", shell_word(file)));
        self.rate_options() + &homography.unwrap_or_default()
    }

    fn rate_options(&self) -> String {
        let numbers = [
            ("fps", self.fps.map(|fps| fps.to_string())),
            ("dt", self.dt.map(|dt| dt.to_string())),
            ("frame-step", self.frame_step.map(|step| step.to_string())),
        ];
        let given = numbers.into_iter();
        given
            .filter_map(|(name, value)| Some(format!(" --{name} {}", value?)))
            .collect::<Vec<_>>()
            .concat()
    }

    /// Whether this file is the homography, which may lie beside recordings.
    pub(crate) fn are_from(&self, file: &Path) -> bool {
        let place = |path: &Path| path.canonicalize().ok();
        let homography = self.homography.as_deref().and_then(place);
        let says = |told: Homography| {
            let text = std::fs::read_to_string(file);
            text.is_ok_and(|text| text.parse() == Ok(told))
        };
        (homography.is_some() && homography == place(file)) || self.remembered.is_some_and(says)
    }

    /// The recording in the file, in metres and steps of 0.4 s, in the format that the file looks like. It is read once, so that it may be a pipe.
    pub(crate) fn read(&self, file: &Path) -> anyhow::Result<InSteps> {
        let recording = self.in_metres(file)?;
        let mut notes: Vec<String> = self.note_of_rate(&recording).into_iter().collect();
        let told = recording.frame_time_told().filter(|_| !self.say_the_rate());
        let Some(frame_time) = self.frame_time().or(told) else {
            let recording = match self.frame_step {
                None => recording,
                Some(step) => recording.with_frame_step(step)?,
            };
            return Ok(InSteps {
                recording,
                clock: Clock::WHOLE,
                notes,
            });
        };
        let steps = recording
            .in_steps(frame_time)
            .with_context(|| file.display().to_string())?;
        if steps.resampled {
            let reason = match whole_frame_step(frame_time) {
                Some(step) => format!("frames do not lie {step} apart, which are 0.4 s"),
                None => format!("0.4 s are {} frames", rounded(TIME_STEP / frame_time)),
            };
            notes.push(format!(
                "{reason}: positions are taken on straight lines between frames, every 0.4 s back from the last one"
            ));
        }
        Ok(InSteps {
            recording: steps.recording,
            clock: Clock::of_parts(steps.parts),
            notes,
        })
    }

    /// What is to be said of a rate that the file itself says, where it is another than was given, or than is taken where nothing is said.
    fn note_of_rate(&self, recording: &Recording) -> Option<String> {
        let (rate, told) = (recording.rate()?, recording.frame_time_told()?);
        let apart = recording.frame_step();
        let of_step = |step: i64| TIME_STEP / step as f64;
        let taken = self.frame_time().or(self.frame_step.map(of_step));
        let same = (taken.unwrap_or(of_step(apart)) / told - 1.0).abs() <= SAME;
        let scenes = format!(
            "the scenes say that {rate} frames follow each other in a second, {apart} apart (--fps {})",
            rounded(1.0 / told)
        );
        match taken {
            _ if same => None,
            None => Some(scenes),
            Some(_) => Some(format!(
                "{} is followed, though {scenes}",
                self.rate_options().trim()
            )),
        }
    }

    fn in_metres(&self, file: &Path) -> anyhow::Result<Recording> {
        if file.as_os_str() == "-" {
            bail!("standard input is read by `ddl forecast -` alone; name a file of tracks");
        }
        if file.is_dir() {
            bail!(
                "{} is a folder; name one of its files of tracks (`ddl data {0}` tells of each)",
                file.display()
            );
        }
        let bytes =
            std::fs::read(file).with_context(|| format!("cannot read {}", file.display()))?;
        let format = Format::guess(file, &bytes);
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        let recording = parse_recording(&bytes, &file.display().to_string(), format)?;
        let recording = recording.with_name(&*name);
        match self.homography()? {
            None => Ok(recording),
            Some(homography) => homography
                .on_the_ground(&recording)
                .with_context(|| file.display().to_string()),
        }
    }

    /// From pixels to metres, where positions are pixels.
    pub(crate) fn homography(&self) -> anyhow::Result<Option<Homography>> {
        let Some(path) = &self.homography else {
            return Ok(self.remembered);
        };
        let text = std::fs::read_to_string(path)
            .with_context(|| format!("cannot read {}", path.display()))?;
        let homography = text.parse().with_context(|| path.display().to_string())?;
        Ok(Some(homography))
    }

    /// Whether it was said how fast frames follow each other.
    pub(crate) fn say_the_rate(&self) -> bool {
        self.frame_time().is_some() || self.frame_step.is_some()
    }

    /// Seconds from one frame number to the next, as far as they were given.
    fn frame_time(&self) -> Option<f64> {
        self.dt.or(self.fps.map(|fps| 1.0 / fps))
    }

    /// Frame numbers in a step of live tracks, as far as they were given.
    pub(crate) fn live_frame_step(&self) -> anyhow::Result<Option<i64>> {
        match self.frame_time() {
            None => Ok(self.frame_step),
            Some(frame_time) => live_step(frame_time).map(Some),
        }
    }
}

/// Frame numbers in a step of live tracks, given the seconds from one to the next.
pub(crate) fn live_step(frame_time: f64) -> anyhow::Result<i64> {
    let Some(step) = whole_frame_step(frame_time) else {
        bail!(
            "0.4 s are {} frames: live tracks are not resampled; give a rate of which 0.4 s are a whole number of frames, or \
             count frames in finer parts",
            rounded(TIME_STEP / frame_time)
        );
    };
    Ok(step)
}

/// To four decimals, for people.
fn rounded(number: f64) -> f64 {
    (1e4 * number).round() / 1e4
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
