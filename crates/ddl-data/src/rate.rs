//! Resampling of recordings to steps of 0.4 s.

use ddl_core::{FRAME_LIMIT, TIME_STEP, is_frame_step};
use thiserror::Error;

use crate::error::RecordingError;
use crate::observation::{Observation, between};
use crate::recording::Recording;

/// Largest relative deviation of a step from 0.4 s, smaller than the variation of walking speeds.
const TOLERANCE: f64 = 0.005;
/// Largest number of parts per frame that is tried, if a step is not a whole number of frames ...
const MOST_PARTS: i64 = 1000;
/// ... and the relative accuracy required.
const FIT: f64 = 1e-4;
/// Spacing of observations (s) above which they no longer show the course of a track.
const SLOWEST: f64 = 1.2;
/// Share of the frame differences that must be multiples of the most common one. It is smaller for a jittering clock.
const EVEN: f64 = 0.95;
/// Observations up to this many usual spacings apart are interpolated; longer gaps stay gaps.
const JOINED: f64 = 1.5;

/// A recording in steps of 0.4 s.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ResampledRecording {
    /// The recording. Its frame numbers count `parts` per frame of the original recording.
    pub recording: Recording,
    /// Parts per original frame; 1 where a step is a whole number of frames.
    pub parts: i64,
    /// Whether positions were interpolated between frames.
    pub resampled: bool,
}

/// Frames per step of 0.4 s, given the seconds per frame, where this is a whole number within 0.5 %.
///
/// ```
/// use ddl_data::whole_frame_step;
/// assert_eq!(whole_frame_step(1.0 / 25.0), Some(10));
/// assert_eq!(whole_frame_step(1.0 / 24.0), None); // 9.6
/// ```
#[must_use]
pub fn whole_frame_step(frame_time: f64) -> Option<i64> {
    whole_multiple(TIME_STEP / frame_time, 1)
}

fn whole_multiple(frames: f64, spacing: i64) -> Option<i64> {
    let multiple = (frames / spacing as f64).round() * spacing as f64;
    fits(multiple, frames, TOLERANCE).then_some(multiple as i64)
}

impl Recording {
    /// Converts the recording to steps of 0.4 s, given the seconds per frame number, such as 0.04 at 25 frames per
    /// second.
    ///
    /// If the frames are evenly spaced and a whole number of the usual spacing makes a step (10 frames of 0.04 s), only
    /// the [`frame_step`](Recording::frame_step) changes. Otherwise positions are interpolated every 0.4 s, counted
    /// back from the last frame, on straight lines between observations no further apart than usual.
    ///
    /// # Errors
    /// [`RateError`] where the time is not positive, observations are more than 1.2 s apart, or frame numbers are too
    /// large.
    pub fn resampled_to_steps(&self, frame_time: f64) -> Result<ResampledRecording, RateError> {
        let frames = TIME_STEP / frame_time;
        // False for NaN.
        if !(frames > 0.0 && is_frame_step(frames.ceil() as i64)) {
            return Err(RateError::FrameTime { found: frame_time });
        }
        let spacing = self.frame_step();
        let apart = spacing as f64 * frame_time;
        if apart > SLOWEST {
            return Err(RateError::TooSlow { apart });
        }
        if let Some(step) = whole_multiple(frames, spacing).filter(|_| self.is_even()) {
            let recording = self.clone().with_frame_step(step)?;
            return Ok(ResampledRecording {
                recording,
                parts: 1,
                resampled: false,
            });
        }
        let whole = |parts: &i64| {
            let step = frames * *parts as f64;
            fits(step.round(), step, FIT)
        };
        // A thousandth of a frame is always accurate enough.
        let parts = (1..MOST_PARTS).find(whole).unwrap_or(MOST_PARTS);
        self.resampled(parts, (frames * parts as f64).round() as i64)
    }

    /// Seconds per frame number according to the [`rate`](Self::rate) of the file; `None` after the
    /// [`frame_step`](Self::frame_step) was set.
    #[must_use]
    pub fn stated_frame_time(&self) -> Option<f64> {
        Some(1.0 / (self.rate()? * self.frame_step() as f64))
    }

    fn is_even(&self) -> bool {
        let differences = self.frames().windows(2).map(|pair| pair[1] - pair[0]);
        let whole = differences.filter(|difference| difference % self.frame_step() == 0);
        whole.count() as f64 >= EVEN * (self.frames().len() - 1) as f64
    }

    /// Positions every `step` parts of a frame, counted back from the last frame.
    fn resampled(&self, parts: i64, step: i64) -> Result<ResampledRecording, RateError> {
        let farthest = self.frames().iter().map(|frame| frame.unsigned_abs()).max();
        let limit = FRAME_LIMIT.unsigned_abs() / parts.unsigned_abs();
        let last = *self.frames().last().unwrap_or(&0);
        if farthest.is_none_or(|frame| frame >= limit) {
            return Err(RateError::Frames { last, parts });
        }
        let end = last * parts;
        let longest = (JOINED * (self.frame_step() * parts) as f64) as i64;
        let mut observations = Vec::new();
        for (pedestrian, track) in self.tracks() {
            let mut add = |frame, position| {
                observations.push(Observation::new(frame, pedestrian, position));
            };
            let placed = track.iter().map(|seen| (seen.frame * parts, seen.position));
            let placed: Vec<_> = placed.collect();
            for &(frame, position) in &placed {
                if (end - frame) % step == 0 {
                    add(frame, position);
                }
            }
            for &[from, to] in placed.array_windows() {
                if to.0 - from.0 <= longest {
                    // The first grid point after `from`.
                    let first = end - (end - from.0 - 1) / step * step;
                    for frame in (first..to.0).step_by(step as usize) {
                        add(frame, between(from, to, frame));
                    }
                }
            }
        }
        let recording = self.with_observations(step, observations)?;
        Ok(ResampledRecording {
            recording,
            parts,
            resampled: true,
        })
    }
}

fn fits(value: f64, wanted: f64, tolerance: f64) -> bool {
    (value - wanted).abs() <= tolerance * wanted
}

/// A recording that cannot be converted to steps of 0.4 s.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum RateError {
    #[error("a frame must take more than 0 s, and 0.4 s must be at most 2^31 frames; found {found} s per frame")]
    FrameTime { found: f64 },
    #[error(
        "observations are {apart:.2} s apart, more than 1.2 s: too few to follow a track; is the rate right, and do \
         the frame numbers count at this rate?"
    )]
    TooSlow { apart: f64 },
    #[error("frame {last} is too large to be divided into {parts} parts; count frames from 0")]
    Frames { last: i64, parts: i64 },
    #[error(transparent)]
    Recording(#[from] RecordingError),
}
