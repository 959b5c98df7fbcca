//! The rules of the game: what a forecaster may see, and how many guesses it has.

use std::{borrow::Cow, fmt, str::FromStr};

use ddl_data::{UnknownName, Window};
use serde::{Deserialize, Serialize};

use crate::{Forecast, Forecaster, error::ForecastError};

/// How a number was measured. Numbers of different protocols are not comparable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Protocol {
    /// As the published DDL code measures: the goal is chosen with the true end.
    Published,
    /// All goals, 20 hypotheses, nothing chosen with the truth but the usual best of 20.
    Fair,
    /// One forecast: the [representative](Forecast::representative) hypothesis.
    Single,
    /// As `Fair`, and besides the windows what was seen in their recording until then.
    Online,
    /// As `Single`, and besides the windows what was seen in their recording until then.
    OnlineSingle,
}

impl Protocol {
    /// The greatest number of hypotheses that any protocol allows: 20.
    pub const MOST_HYPOTHESES: usize = 20;

    /// Every protocol, in the order of printing.
    pub const ALL: [Self; 5] = [
        Self::Published,
        Self::Fair,
        Self::Single,
        Self::Online,
        Self::OnlineSingle,
    ];

    /// `published`, `fair`, `single`, `online` or `online-single`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Published => "published",
            Self::Fair => "fair",
            Self::Single => "single",
            Self::Online => "online",
            Self::OnlineSingle => "online-single",
        }
    }

    /// What is measured, in one sentence.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Published => {
                "one goal a pedestrian (of 20 cluster centres, the one nearest the true end), then 20 \
                 noise samples on that goal; the best of 20 is scored; the goal query reads the first \
                 future frame"
            }
            Self::Fair => {
                "at most 20 weighted hypotheses a pedestrian from the 8 observed frames alone; the \
                 best of them is scored; a trained model is that of the last epoch, or chosen on a validation \
                 split of the training scenes"
            }
            Self::Single => {
                "one forecast a pedestrian from the 8 observed frames alone: what a forecaster gives as its one \
                 forecast (DDL: the neutral motion to its central goal), otherwise the hypothesis of least expected ADE under \
                 their own weights (all alike where there are none); nothing is chosen with the truth"
            }
            Self::Online => {
                "as `fair`, and besides the 8 observed frames the tracks of the SAME recording before the last \
                 observed frame, as a camera knows them that has watched it from the start; nothing later is read"
            }
            Self::OnlineSingle => {
                "as `single`, and besides the 8 observed frames the tracks of the SAME recording before the last \
                 observed frame, as a camera knows them that has watched it from the start; nothing later is read"
            }
        }
    }

    /// What a reader must be told beside a number of this protocol.
    pub const fn warning(self) -> Option<&'static str> {
        match self {
            Self::Published => Some(
                "The goal of each pedestrian is chosen with the TRUE end (the nearest of 20 centres), \
                 and 20 noise samples are then drawn on it and the best is kept: up to 400 candidates \
                 stand behind a \"best of 20\". The goal query also reads one future frame (frame 9), \
                 and the published code keeps the epoch that is best on the TEST set. No system can \
                 reach these numbers in use; they serve to reproduce the published tables.",
            ),
            Self::Fair | Self::Single | Self::Online | Self::OnlineSingle => None,
        }
    }

    /// The number of hypotheses a pedestrian may have: 20, or 1.
    pub const fn hypotheses(self) -> usize {
        match self {
            Self::Published | Self::Fair | Self::Online => Self::MOST_HYPOTHESES,
            Self::Single | Self::OnlineSingle => 1,
        }
    }

    /// Whether forecasters are shown the true future of the windows.
    pub const fn shows_future(self) -> bool {
        matches!(self, Self::Published)
    }

    /// Whether forecasters are shown what was seen in the recording of a window before it.
    pub const fn shows_past(self) -> bool {
        matches!(self, Self::Online | Self::OnlineSingle)
    }

    /// The windows as a forecaster sees them: without their futures, but under `published`.
    pub fn visible(self, windows: &[Window]) -> Cow<'_, [Window]> {
        if self.shows_future() {
            Cow::Borrowed(windows)
        } else {
            Cow::Owned(windows.iter().map(Window::without_future).collect())
        }
    }

    /// Forecasts the windows as this protocol demands: their futures are cut off first, but under `published`.
    ///
    /// # Errors
    /// The forecaster failed, or made more hypotheses than the protocol allows.
    pub fn forecast(
        self,
        forecaster: &(impl Forecaster + ?Sized),
        windows: &[Window],
    ) -> Result<Vec<Forecast>, ForecastError> {
        let forecasts = forecaster.forecast_all(&self.visible(windows))?;
        self.admit(forecasts, &forecaster.name())
    }

    /// Holds forecasts of [visible](Self::visible) windows to the number of hypotheses allowed: `single` keeps the
    /// representative one, otherwise too many are an error.
    ///
    /// # Errors
    /// A forecast has more hypotheses than the protocol allows.
    pub fn admit(
        self,
        forecasts: Vec<Forecast>,
        forecaster: &str,
    ) -> Result<Vec<Forecast>, ForecastError> {
        if self.hypotheses() == 1 {
            return Ok(forecasts.iter().map(Forecast::single).collect());
        }
        match forecasts
            .iter()
            .map(Forecast::hypotheses)
            .find(|&k| k > self.hypotheses())
        {
            None => Ok(forecasts),
            Some(found) => Err(ForecastError::TooManyHypotheses {
                protocol: self,
                forecaster: forecaster.to_owned(),
                allowed: self.hypotheses(),
                found,
            }),
        }
    }
}

impl fmt::Display for Protocol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Protocol {
    type Err = UnknownName;

    fn from_str(word: &str) -> Result<Self, UnknownName> {
        let expected = "published, fair, single, online, online-single";
        UnknownName::find(word, &Self::ALL, Self::name, "protocol", expected)
    }
}
