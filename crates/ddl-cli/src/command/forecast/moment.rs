//! The forecasts of some frames, and the state that one group of frames passes on to the next.

use crate::telling::tell;
use ddl::data::{Clock, FrameNumber, HORIZON, OBSERVED, SceneName, Window};
use ddl::dynamics::LyapunovCertificate;
use ddl::{AdaptiveRegions, CertifiedForecast};
use std::collections::BTreeMap;

/// Windows in order of time.
#[derive(Debug, Clone, Copy)]
pub(super) struct SceneWindows<'a> {
    pub(super) windows: &'a [Window],
    /// The scene of each window; empty if the tracks name no scenes.
    pub(super) scenes: &'a [Option<SceneName>],
}

/// Forecasts of the windows, one for each.
pub(super) enum WindowForecasts {
    Plain(Vec<ddl::Forecast>),
    Certified(Vec<CertifiedForecast>),
}

impl WindowForecasts {
    /// The forecasts, each with the certificates if there are any.
    fn with_certificates(&self) -> Vec<(&ddl::Forecast, Option<&CertifiedForecast>)> {
        match self {
            Self::Plain(forecasts) => forecasts.iter().map(|forecast| (forecast, None)).collect(),
            Self::Certified(certified) => certified.iter().map(|one| (&one.forecast, Some(one))).collect(),
        }
    }

    pub(super) fn each_mut(&mut self) -> Vec<&mut ddl::Forecast> {
        match self {
            Self::Plain(forecasts) => forecasts.iter_mut().collect(),
            Self::Certified(certified) => certified.iter_mut().map(|one| &mut one.forecast).collect(),
        }
    }
}

impl<'a> SceneWindows<'a> {
    pub(super) fn moments(self, forecasts: &'a WindowForecasts, clock: Clock) -> Vec<Moment<'a>> {
        let pairs = self.windows.iter().zip(forecasts.with_certificates()).enumerate();
        let moments = pairs.map(|(i, (window, (forecast, certified)))| Moment {
            scene: self.scenes.get(i).and_then(Option::as_ref),
            window,
            forecast,
            certified,
            clock,
        });
        moments.collect()
    }
}

/// The motions so far, and those unlike the training motions.
#[derive(Debug, Default)]
pub(super) struct UnfamiliarMotions {
    motions: usize,
    unfamiliar: usize,
    /// The pedestrian and the frame of the first.
    first: Option<(String, FrameNumber)>,
    /// Whether the warning has been given.
    is_told: bool,
}

impl UnfamiliarMotions {
    pub(super) fn add(&mut self, moments: &[Moment<'_>]) {
        for moment in moments {
            for i in 0..moment.window.len() {
                self.motions += 1;
                let familiarity = moment.forecast.familiarity(i);
                if familiarity.is_some_and(|f| f < ddl::UNFAMILIAR_THRESHOLD) {
                    self.unfamiliar += 1;
                    self.first
                        .get_or_insert_with(|| (moment.who(i), moment.observed_until()));
                }
            }
        }
    }

    /// Warns, once, of motions whose forecasts are less certain.
    pub(super) fn warn(&mut self, note: &str) {
        let Some((who, frame)) = self.first.as_ref().filter(|_| !self.is_told) else {
            return;
        };
        tell(format_args!(
            "warning: {} of {} motions are unlike the training motions (familiarity below {}), first that of \
             pedestrian {who} observed until frame {frame}: their forecasts use little of the network, and their \
             weights are flatter{note}",
            self.unfamiliar,
            self.motions,
            ddl::UNFAMILIAR_THRESHOLD,
        ));
        self.is_told = true;
    }
}

/// State that one chunk of forecasts passes on to the next.
#[derive(Debug, Default)]
pub(super) struct StreamState {
    pub(super) headed: bool,
    pub(super) unfamiliar: UnfamiliarMotions,
    is_violation_told: bool,
    /// The adaptive regions of each scene.
    regions: BTreeMap<Option<SceneName>, AdaptiveRegions>,
}

impl StreamState {
    /// The forecast of window `i` with the adaptive regions of its scene.
    pub(super) fn adapted(&mut self, windows: SceneWindows<'_>, i: usize, forecast: ddl::Forecast) -> ddl::Forecast {
        let scene = windows.scenes.get(i).cloned().flatten();
        self.regions
            .entry(scene)
            .or_default()
            .adapt(&windows.windows[i], forecast)
    }

    pub(super) fn forget(&mut self, scene: &SceneName) {
        self.regions.remove(&Some(scene.clone()));
    }
}

/// The forecast at one frame.
pub(super) struct Moment<'a> {
    pub(super) scene: Option<&'a SceneName>,
    pub(super) window: &'a Window,
    pub(super) forecast: &'a ddl::Forecast,
    pub(super) certified: Option<&'a CertifiedForecast>,
    pub(super) clock: Clock,
}

impl<'a> Moment<'a> {
    pub(super) fn certificate(&self, i: usize, hypothesis: usize) -> Option<&'a LyapunovCertificate<f64>> {
        Some(self.certified?.certificate(i, hypothesis))
    }

    /// The name of a pedestrian in messages.
    pub(super) fn who(&self, i: usize) -> String {
        let name = self.window.name(i);
        match self.scene {
            None => name.to_string(),
            Some(scene) => format!("{name} of scene {scene}"),
        }
    }

    pub(super) fn observed_until(&self) -> FrameNumber {
        self.clock.number(self.window.frames()[OBSERVED - 1])
    }

    pub(super) fn frames(&self) -> Vec<FrameNumber> {
        let (last, step) = (self.window.frames()[OBSERVED - 1], self.window.frame_step());
        let frames = (1..=HORIZON as i64).map(|t| self.clock.number(last + t * step));
        frames.collect()
    }
}

/// Stable steps keep the guarantee for any output of the network. If one violates it, a user who relies on the
/// forecasts must know.
pub(super) fn warn_of_violation(moments: &[Moment<'_>], state: &mut StreamState) {
    if state.is_violation_told {
        return;
    }
    let first = moments.iter().find_map(|moment| {
        let (i, hypothesis, violation) = moment.certified?.first_violation()?;
        Some((moment, i, hypothesis, violation))
    });
    if let Some((moment, i, hypothesis, violation)) = first {
        state.is_violation_told = true;
        tell(format_args!(
            "warning: not every certificate holds; the first that does not is that of pedestrian {}, \
             observed until frame {}, hypothesis {hypothesis}: {violation}",
            moment.who(i),
            moment.observed_until(),
        ));
    }
}
