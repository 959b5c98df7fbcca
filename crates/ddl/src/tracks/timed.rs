//! Rows of a file on the clock of their frames, with what was assumed about it.

use crate::error::DdlError;
use crate::note::Note;
use crate::run::track_units::TrackUnits;
use ddl_core::{Setting, TIME_STEP};
use ddl_data::{Clock, ClockError, Recording};

/// Rates with a smaller relative difference count as equal.
const SAME: f64 = 0.005;

/// A recording in ticks of its clock.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct TimedRecording {
    /// The recording.
    pub recording: Recording,
    /// The clock of its frames or times.
    pub clock: Clock,
    /// Its frame step, if nobody gives the rate.
    pub guessed: Option<Note>,
    /// What the reader assumed or left out, and its rate.
    pub notes: Vec<Note>,
}

impl TimedRecording {
    /// Rows as they were read, with the rate that is given, else that of the file, else the remembered one.
    ///
    /// # Errors
    /// [`DdlError::Rate`] if a rate is given for rows with times, [`DdlError::Clock`] for a rate out of range.
    pub fn new(rows: &Recording, given: &TrackUnits, remembered: &TrackUnits) -> Result<Self, DdlError> {
        if let (Some(given), Some(_)) = (given.rate_setting(), rows.time_unit()) {
            return Err(DdlError::Rate { given });
        }
        let mut notes: Vec<Note> = rows.notes().iter().cloned().map(Note::Reader).collect();
        notes.extend(note_of_rate(rows, given, remembered));
        let stated = || rows.stated_clock().transpose();
        let clock = given.clock()?.map_or_else(stated, |clock| Ok(Some(clock)))?;
        let clock = clock.map_or_else(|| remembered.clock(), |clock| Ok(Some(clock)))?;
        let step = || many_frames(rows.frame_step());
        let guessed = clock.is_none().then(|| Note::AssumedStep { step: step() });
        let clock = clock.map_or_else(|| Clock::with_frame_step(rows.frame_step()), Ok)?;
        Ok(Self { notes, recording: rows.on_clock(clock)?, clock, guessed })
    }
}

impl TrackUnits {
    /// The clock of these units, if they have a rate.
    ///
    /// # Errors
    /// A rate that is out of range.
    pub fn clock(&self) -> Result<Option<Clock>, ClockError> {
        let of_step = self.frame_step.map(Clock::with_frame_step);
        self.frame_time().map(Clock::with_frame_time).or(of_step).transpose()
    }

    /// The rate as it was given, such as `fps 25`.
    pub fn rate_setting(&self) -> Option<String> {
        let fps = self.fps.map(|fps| Setting::Fps.to(fps));
        let dt = self.dt.map(|dt| Setting::Dt.to(dt));
        let step = self.frame_step.map(|step| Setting::FrameStep.to(step));
        dt.or(fps).or(step)
    }

    /// Seconds between consecutive frame numbers, if `fps` or `dt` is given.
    fn frame_time(&self) -> Option<f64> {
        self.dt.or(self.fps.map(|fps| 1.0 / fps))
    }
}

/// A note if the rate in the file differs from the one given, remembered or guessed.
fn note_of_rate(rows: &Recording, given: &TrackUnits, remembered: &TrackUnits) -> Option<Note> {
    let (rate, told) = (rows.rate()?, rows.stated_frame_time()?);
    let apart = rows.frame_step();
    let of_step = |step: i64| TIME_STEP / step as f64;
    let option = given.rate_setting();
    let otherwise = if option.is_some() { given } else { remembered };
    let otherwise = otherwise.frame_time().or(otherwise.frame_step.map(of_step));
    let same = (otherwise.unwrap_or(of_step(apart)) / told - 1.0).abs() <= SAME;
    let scenes = format!("the file gives {rate} frames per second, and its frame numbers increase by {apart}");
    let of_file = Setting::Fps.to((1e4 / told).round() / 1e4);
    match option {
        _ if same => None,
        None => Some(Note::Reader(format!("{scenes}: read as {of_file}"))),
        Some(option) => Some(Note::Reader(format!("read as {option}, although {scenes} ({of_file})"))),
    }
}

pub(crate) fn many_frames(count: i64) -> String {
    format!("{count} {}", if count == 1 { "frame" } else { "frames" })
}
