//! Frame numbers for output, if the tracks were resampled and count parts of a raw frame.

use ddl::data::PlausibilityWarning;
use serde::Serialize;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Clock {
    parts: i64,
}

/// A frame number of the tracks; a fraction where a step of 0.4 s ends between two frames.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub(crate) enum FrameNumber {
    Whole(i64),
    Between(f64),
}

impl Clock {
    pub(crate) const WHOLE: Self = Self { parts: 1 };

    pub(crate) fn of_parts(parts: i64) -> Self {
        Self { parts }
    }

    pub(crate) fn nearest(self, frame: i64) -> i64 {
        match self.number(frame) {
            FrameNumber::Whole(frame) => frame,
            FrameNumber::Between(frame) => frame.round() as i64,
        }
    }

    pub(crate) fn of_warning(self, warning: PlausibilityWarning) -> PlausibilityWarning {
        match warning {
            PlausibilityWarning::Jump(mut fastest) => {
                fastest.frame = self.nearest(fastest.frame);
                PlausibilityWarning::Jump(fastest)
            }
            PlausibilityWarning::NoSteps { frame_step } => PlausibilityWarning::NoSteps {
                frame_step: self.nearest(frame_step),
            },
            other => other,
        }
    }

    pub(crate) fn number(self, frame: i64) -> FrameNumber {
        if frame % self.parts == 0 {
            FrameNumber::Whole(frame / self.parts)
        } else {
            FrameNumber::Between(frame as f64 / self.parts as f64)
        }
    }
}

impl FrameNumber {
    /// Rounded to four decimals for tables and messages.
    pub(crate) fn rounded(self) -> Self {
        match self {
            Self::Whole(frame) => Self::Whole(frame),
            Self::Between(frame) => Self::Between((frame * 1e4).round() / 1e4),
        }
    }
}

impl std::fmt::Display for FrameNumber {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.rounded() {
            Self::Whole(frame) => frame.fmt(f),
            Self::Between(frame) => frame.fmt(f),
        }
    }
}
