//! From frame numbers and time stamps to ticks, of which a whole number makes a step of 0.4 s.

use std::fmt;

use ddl_core::{TIME_STEP, is_frame, is_frame_step};
use serde::{Serialize, Serializer};
use thiserror::Error;
use time::OffsetDateTime;
use time::format_description::well_known::Rfc3339;

/// Largest relative deviation of a step from 0.4 s, smaller than the variation of walking speeds.
const TOLERANCE: f64 = 0.005;
/// Largest number of ticks per frame that is tried, if a step is not a whole number of frames ...
const MOST_TICKS: i64 = 1000;
/// ... and the relative accuracy required.
const FIT: f64 = 1e-4;
/// Ticks per second of time stamps: microseconds, because nanoseconds since 1970 are not exact in an `f64`.
pub(crate) const STAMPS_A_SECOND: i64 = 1_000_000;

/// What a column of times counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum TimeUnit {
    /// Seconds, with fractions.
    Seconds,
    /// Milliseconds.
    Milliseconds,
    /// Microseconds.
    Microseconds,
    /// Nanoseconds; rounded to microseconds.
    Nanoseconds,
    /// Dates with times (ISO 8601). Without an offset they count as UTC.
    Dates,
}

ddl_core::named!(TimeUnit, "unit of time", Seconds => "seconds", Milliseconds => "milliseconds",
    Microseconds => "microseconds", Nanoseconds => "nanoseconds", Dates => "dates");

impl TimeUnit {
    /// Units per second, and their sign; `None` for dates.
    pub(crate) fn a_second(self) -> Option<(i64, &'static str)> {
        match self {
            Self::Seconds => Some((1, "s")),
            Self::Milliseconds => Some((1_000, "ms")),
            Self::Microseconds => Some((1_000_000, "us")),
            Self::Nanoseconds => Some((1_000_000_000, "ns")),
            Self::Dates => None,
        }
    }
}

/// How the frame numbers, or time stamps, of tracks count time. Windows count *ticks*: a frame has one or several, and
/// a step of 0.4 s is a whole number of them.
///
/// ```
/// use ddl_data::{Clock, FrameNumber};
///
/// assert_eq!(Clock::with_frame_time(0.04)?.frame_step(), 10); // 25 frames a second: a tick is a frame
/// let seven = Clock::with_frame_time(1.0 / 7.0)?; // a step of 2.8 frames
/// assert_eq!((seven.tick(3)?, seven.frame_step()), (15, 14));
/// assert_eq!(seven.number(29), FrameNumber::Between(5.8));
/// # Ok::<(), ddl_data::ClockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Clock {
    count: Count,
    frame_step: i64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Count {
    /// Frames, each of so many ticks.
    Frames { ticks: i64 },
    /// Time stamps in microseconds.
    Stamps(TimeUnit),
}

/// The frame number or time of a tick, as the file writes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrameNumber {
    /// A frame number, or a whole time.
    Whole(i64),
    /// Between two frames, or a time with a fraction.
    Between(f64),
    /// A date with a time.
    Date(OffsetDateTime),
}

impl Clock {
    /// Frames that are steps: 0.4 s each.
    pub const STEPS: Self = Self { count: Count::Frames { ticks: 1 }, frame_step: 1 };

    /// Frames of which this number makes a step of 0.4 s, such as 10 at 25 frames a second.
    ///
    /// # Errors
    /// [`ClockError::FrameStep`] for a number outside 1..=2^31.
    pub fn with_frame_step(frame_step: i64) -> Result<Self, ClockError> {
        if !is_frame_step(frame_step) {
            return Err(ClockError::FrameStep { found: frame_step });
        }
        Ok(Self { frame_step, ..Self::STEPS })
    }

    /// Frames of so many seconds, such as 0.04 at 25 frames a second. A step that is a whole number of frames within
    /// 0.5 % is taken as that.
    ///
    /// # Errors
    /// [`ClockError::FrameTime`] where the time is not positive, or too short or long for a step.
    pub fn with_frame_time(seconds: f64) -> Result<Self, ClockError> {
        let frames = TIME_STEP / seconds;
        // False for NaN.
        if !(frames >= 1e-3 && frames.ceil() < (1_i64 << 31) as f64) {
            return Err(ClockError::FrameTime { found: seconds });
        }
        if let Some(frame_step) = nearest_whole(frames, TOLERANCE) {
            return Self::with_frame_step(frame_step);
        }
        let mut counts = 1..MOST_TICKS;
        let fitting = counts.find_map(|ticks| Some((ticks, nearest_whole(frames * ticks as f64, FIT)?)));
        // A thousandth of a frame is always accurate enough.
        let (ticks, frame_step) = fitting.unwrap_or((MOST_TICKS, (frames * MOST_TICKS as f64).round() as i64));
        Ok(Self { count: Count::Frames { ticks }, frame_step })
    }

    /// Time stamps, given in microseconds; printed in the unit of their column.
    #[must_use]
    pub fn with_stamps(unit: TimeUnit) -> Self {
        Self { count: Count::Stamps(unit), frame_step: (TIME_STEP * STAMPS_A_SECOND as f64) as i64 }
    }

    /// Ticks as frames; `frame_step` is in 1..=2^31.
    pub(crate) fn of_ticks(frame_step: i64) -> Self {
        Self { frame_step, ..Self::STEPS }
    }

    /// Ticks per step of 0.4 s.
    pub fn frame_step(self) -> i64 {
        self.frame_step
    }

    /// Frames, or microseconds of time stamps, per second.
    pub(crate) fn frames_a_second(self) -> f64 {
        let ticks = match self.count {
            Count::Frames { ticks } => ticks,
            Count::Stamps(_) => 1,
        };
        self.frame_step as f64 / (ticks as f64 * TIME_STEP)
    }

    /// Whether frame numbers are ticks.
    pub fn counts_frames(self) -> bool {
        self.count == Count::Frames { ticks: 1 }
    }

    /// Whether ticks are time stamps.
    pub fn counts_times(self) -> bool {
        matches!(self.count, Count::Stamps(_))
    }

    /// The tick of a frame number, or of a time stamp in microseconds.
    ///
    /// # Errors
    /// [`ClockError::Frame`] for a frame number that is too large to be divided.
    pub fn tick(self, frame: i64) -> Result<i64, ClockError> {
        let Count::Frames { ticks } = self.count else { return Ok(frame) };
        let tick = frame.checked_mul(ticks).filter(|tick| is_frame(*tick));
        // A number that needs no division is checked where it is used.
        tick.or((ticks == 1).then_some(frame)).ok_or(ClockError::Frame { frame, ticks })
    }

    /// Microseconds at a tick: those of time stamps or, of frames, since frame 0.
    pub fn microseconds(self, tick: i64) -> i64 {
        let microseconds = i128::from(tick) * i128::from(STAMPS_A_SECOND) * 2 / (5 * i128::from(self.frame_step));
        // Below 2^53 ticks of at least 0.4 s / 2^31.
        microseconds as i64
    }

    /// The step of 0.4 s, in the unit of the file; in seconds for dates.
    pub fn step_number(self) -> FrameNumber {
        match self.count {
            Count::Stamps(TimeUnit::Dates) => FrameNumber::Between(TIME_STEP),
            _ => self.number(self.frame_step),
        }
    }

    /// A tick in words, such as `frame 12`, `2.3 s` or a date: each tick has its own.
    pub fn words(self, tick: i64) -> String {
        let number = self.number(tick);
        match self.count {
            Count::Frames { .. } => format!("frame {number}"),
            Count::Stamps(unit) => unit.a_second().map_or(number.to_string(), |(_, sign)| format!("{number} {sign}")),
        }
    }

    /// The frame number or time of a tick.
    pub fn number(self, tick: i64) -> FrameNumber {
        let unit = match self.count {
            Count::Frames { ticks } => return FrameNumber::of_parts(tick, ticks),
            Count::Stamps(unit) => unit,
        };
        match unit.a_second() {
            Some((a_second, _)) if a_second > STAMPS_A_SECOND => FrameNumber::Whole(tick.saturating_mul(1000)),
            Some((a_second, _)) => FrameNumber::of_parts(tick, STAMPS_A_SECOND / a_second),
            None => match OffsetDateTime::from_unix_timestamp_nanos(i128::from(tick) * 1000) {
                Ok(date) => FrameNumber::Date(date),
                Err(_) => FrameNumber::of_parts(tick, STAMPS_A_SECOND),
            },
        }
    }
}

impl FrameNumber {
    fn of_parts(tick: i64, ticks: i64) -> Self {
        if tick % ticks == 0 { Self::Whole(tick / ticks) } else { Self::Between(tick as f64 / ticks as f64) }
    }

    /// The nearest whole number; seconds since 1970 for a date.
    pub fn nearest(self) -> i64 {
        match self {
            Self::Whole(frame) => frame,
            Self::Between(frame) => frame.round() as i64,
            Self::Date(date) => date.unix_timestamp(),
        }
    }

    /// Rounded to six decimals, for tables and messages.
    #[must_use]
    pub fn rounded(self) -> Self {
        match self {
            Self::Between(frame) => Self::Between((frame * 1e6).round() / 1e6),
            other => other,
        }
    }
}

impl fmt::Display for FrameNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.rounded() {
            Self::Whole(frame) => frame.fmt(f),
            Self::Between(frame) => frame.fmt(f),
            Self::Date(date) => f.write_str(&date.format(&Rfc3339).unwrap_or_default()),
        }
    }
}

impl Serialize for FrameNumber {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Whole(frame) => serializer.serialize_i64(*frame),
            Self::Between(frame) => serializer.serialize_f64(*frame),
            Self::Date(_) => serializer.collect_str(self),
        }
    }
}

/// The whole number nearest to a number, if it is at most `tolerance` of it away.
fn nearest_whole(number: f64, tolerance: f64) -> Option<i64> {
    let nearest = number.round();
    (nearest >= 1.0 && (nearest - number).abs() <= tolerance * number).then_some(nearest as i64)
}

/// A clock that cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum ClockError {
    #[error("the frame step must lie in 1..=2^31 raw frames, found {found}")]
    FrameStep { found: i64 },
    #[error(
        "a frame must take more than 0 s and at most 400 s, and 0.4 s must be at most 2^31 frames; found {found:?} s \
         per frame"
    )]
    FrameTime { found: f64 },
    #[error(
        "the rows of a pedestrian are {apart:.2} s apart, more than 1.2 s: too few to follow a track; is the rate \
         right, and do the frame numbers count at this rate? A column of milliseconds is called time_ms"
    )]
    TooSlow { apart: f64 },
    #[error(
        "the rows of a pedestrian are {apart:.1e} s apart, closer than 1 ms: is the rate right? Times must count \
         seconds (column time), or time_ms, time_us or time_ns, not days or minutes"
    )]
    TooFast { apart: f64 },
    #[error("frame {frame} is too large to be divided into {ticks} parts; count frames from 0")]
    Frame { frame: i64, ticks: i64 },
}
