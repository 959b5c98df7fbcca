//! Frame numbers and times, as the user counts them.

use crate::arrays::array;
use crate::errors::{ensure, of_any};
use ddl::data::{Clock, FrameNumber, TimeUnit};
use numpy::datetime::{Datetime, units::Microseconds};
use pyo3::prelude::*;

/// From the ticks of windows to the frame numbers or times of the user.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UserMoments {
    pub(crate) clock: Clock,
    /// What times count; `None` for frame numbers.
    pub(crate) unit: Option<TimeUnit>,
}

impl UserMoments {
    /// Frame numbers that are ticks.
    pub(crate) const FRAMES: Self = Self { clock: Clock::STEPS, unit: None };

    pub(crate) fn of_times(unit: TimeUnit) -> Self {
        Self { clock: Clock::with_stamps(unit), unit: Some(unit) }
    }

    /// A number, or a `datetime64`.
    pub(crate) fn one(self, py: Python<'_>, tick: i64) -> PyResult<Py<PyAny>> {
        let one = self.all(py, vec![tick])?.bind(py).get_item(0)?;
        let is_date = self.unit == Some(TimeUnit::Dates);
        Ok(if is_date { one } else { one.call_method0("item")? }.unbind())
    }

    /// An array of whole numbers, of numbers with fractions, or of `datetime64`.
    pub(crate) fn all(self, py: Python<'_>, ticks: Vec<i64>) -> PyResult<Py<PyAny>> {
        let n = ticks.len();
        let numbers = || ticks.iter().map(|&tick| self.clock.number(tick));
        let whole = |number| match number {
            FrameNumber::Whole(number) => Some(number),
            _ => None,
        };
        match self.unit {
            Some(TimeUnit::Dates) => {
                let dates = ticks.into_iter().map(Datetime::<Microseconds>::from);
                return array(py, dates.collect(), [n]);
            }
            Some(TimeUnit::Seconds) => {}
            _ => {
                if let Some(numbers) = numbers().map(whole).collect::<Option<Vec<i64>>>() {
                    return array(py, numbers, [n]);
                }
            }
        }
        let fractions = numbers().map(|number| match number {
            FrameNumber::Whole(number) => number as f64,
            FrameNumber::Between(number) => number,
            FrameNumber::Date(_) => f64::NAN,
        });
        array(py, fractions.collect(), [n])
    }

    /// The frame numbers, or the time, in 0.4 s; seconds for dates.
    pub(crate) fn step(self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let counted = match self.unit {
            Some(TimeUnit::Dates) => Self::of_times(TimeUnit::Seconds),
            _ => self,
        };
        counted.one(py, self.clock.frame_step())
    }

    /// A frame or time in words.
    pub(crate) fn words(self, tick: i64) -> String {
        let kind = if self.unit.is_some() { "time" } else { "frame" };
        format!("{kind} {}", self.clock.number(tick))
    }
}

/// The clock of frame numbers that count so many a second.
pub(crate) fn clock_of_rate(fps: f64) -> PyResult<Clock> {
    ensure!(fps.is_finite() && fps > 0.0, "fps must be a finite number above 0, the frames per second; found {fps}");
    Clock::with_frame_time(fps.recip()).map_err(of_any)
}
