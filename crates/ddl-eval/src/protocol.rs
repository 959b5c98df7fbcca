//! Evaluation protocols: the input that a forecaster sees, and its number of hypotheses.

use std::borrow::Cow;

use ddl_core::{Forecast, ForecastError, Forecaster, Window};
use serde::{Deserialize, Serialize};

/// An evaluation protocol. Numbers of different protocols are not comparable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Protocol {
    /// The protocol of the published DDL code: the goal is chosen with the true endpoint.
    Published,
    /// Up to 20 hypotheses. The true future is used only to choose the best of 20 in the metrics.
    Fair,
    /// One forecast: the [representative](Forecast::representative) hypothesis.
    Single,
    /// As `Fair`, with the part of the recording before each window as further input.
    Online,
    /// As `Single`, with the part of the recording before each window as further input.
    OnlineSingle,
    /// Up to 20 futures of a whole scene. The true future is used only to choose the best of 20, once for the scene.
    Joint,
}

impl Protocol {
    /// The greatest number of hypotheses that any protocol allows: 20.
    pub(crate) const MAX_HYPOTHESES: usize = 20;

    /// The names of the two errors that its tables begin with: [`Scores::errors`](crate::Scores::errors).
    pub const fn errors(self) -> [&'static str; 2] {
        match self {
            Self::Joint => ["JADE", "JFDE"],
            _ => ["minADE", "minFDE"],
        }
    }

    /// What is measured, in one sentence.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Published => {
                "one goal for each pedestrian (of 20 cluster centres, the one nearest the true end), then 20 \
                 noise samples on that goal; the best of 20 is scored; the goal query reads the first \
                 future frame"
            }
            Self::Fair => {
                "at most 20 weighted hypotheses for each pedestrian from the 8 observed frames alone; the \
                 best of them is scored; a trained model is that of the last epoch, or chosen on a validation \
                 split of the training scenes"
            }
            Self::Single => {
                "one forecast for each pedestrian from the 8 observed frames alone: the single forecast of a \
                 forecaster that has one (DDL: the neutral motion to its central goal), otherwise the hypothesis of \
                 least expected ADE under the weights (equal ones where there are none); nothing is chosen with the \
                 truth"
            }
            Self::Online => {
                "as `fair`, with the tracks of the SAME recording before the last observed frame as further input, as \
                 known to a camera that has watched from the start; nothing later is read"
            }
            Self::OnlineSingle => {
                "as `single`, with the tracks of the SAME recording before the last observed frame as further input, \
                 as known to a camera that has watched from the start; nothing later is read"
            }
            Self::Joint => {
                "at most 20 futures of the whole scene from the 8 observed frames alone: hypothesis k of all \
                 pedestrians is future k; the best future is chosen once for the scene; a trained model is that of \
                 `fair`"
            }
        }
    }

    /// The warning to print beside numbers of this protocol.
    pub const fn warning(self) -> Option<&'static str> {
        match self {
            Self::Published => Some(
                "The goal of each pedestrian is chosen with the TRUE end (the nearest of 20 centres), \
                 then 20 noise samples are drawn on it and the best is kept: a \"best of 20\" \
                 has up to 400 candidates. The goal query also reads one future frame (frame 9), \
                 and the published code keeps the epoch that is best on the TEST set. No system can \
                 reach these numbers in use; they serve to reproduce the published tables.",
            ),
            _ => None,
        }
    }

    /// The largest number of hypotheses for each pedestrian: 20 or 1.
    pub const fn hypotheses(self) -> usize {
        match self {
            Self::Published | Self::Fair | Self::Online | Self::Joint => Self::MAX_HYPOTHESES,
            Self::Single | Self::OnlineSingle => 1,
        }
    }

    /// Whether forecasters see the true future of the windows.
    pub(crate) const fn gives_future(self) -> bool {
        matches!(self, Self::Published)
    }

    /// Whether forecasters see the part of the recording before a window.
    pub const fn gives_recording_memory(self) -> bool {
        matches!(self, Self::Online | Self::OnlineSingle)
    }

    /// The windows as a forecaster sees them: without their futures, except under `published`.
    pub fn visible(self, windows: &[Window]) -> Cow<'_, [Window]> {
        if self.gives_future() {
            Cow::Borrowed(windows)
        } else {
            Cow::Owned(windows.iter().map(Window::without_future).collect())
        }
    }

    /// Forecasts the windows under this protocol: their futures are cut off first, except under `published`.
    ///
    /// # Errors
    /// The forecaster failed, or made more hypotheses than the protocol allows.
    pub fn forecast(
        self,
        forecaster: &(impl Forecaster + ?Sized),
        windows: &[Window],
    ) -> Result<Vec<Forecast>, ForecastError> {
        let forecasts = forecaster.forecast_all(&self.visible(windows))?.into_iter();
        let scored = forecasts.zip(windows).map(|(forecast, window)| forecast.without_bystanders(window));
        self.admit(scored.collect(), &forecaster.name())
    }

    /// Limits forecasts of [visible](Self::visible) windows to the allowed number of hypotheses: `single` keeps the
    /// representative one; under other protocols too many are an error.
    ///
    /// # Errors
    /// A forecast has more hypotheses than the protocol allows.
    pub fn admit(self, forecasts: Vec<Forecast>, forecaster: &str) -> Result<Vec<Forecast>, ForecastError> {
        if self.hypotheses() == 1 {
            return Ok(forecasts.iter().map(Forecast::single).collect());
        }
        match forecasts.iter().map(Forecast::hypotheses).find(|&k| k > self.hypotheses()) {
            None => Ok(forecasts),
            Some(found) => Err(ForecastError::TooManyHypotheses {
                protocol: self.name(),
                forecaster: forecaster.to_owned(),
                allowed: self.hypotheses(),
                found,
            }),
        }
    }
}

ddl_core::named!(
    Protocol, "protocol",
    Published => "published", Fair => "fair", Single => "single", Online => "online",
    OnlineSingle => "online-single", Joint => "joint"
);
