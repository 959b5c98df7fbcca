//! The forecasts of some frames, and the state that one group of frames passes on to the next.

use crate::telling::tell;
use ddl::data::{Clock, SceneName, Window};
use ddl::{AdaptiveRegions, CertifiedForecast, Moment, UnfamiliarMotions};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Windows in order of time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SceneWindows<'a> {
    pub(crate) windows: &'a [Window],
    /// The scene of each window; empty if the tracks name no scenes.
    pub(crate) scenes: &'a [Option<SceneName>],
}

impl<'a> SceneWindows<'a> {
    /// The moments of the windows with the forecast of each.
    pub(crate) fn moments(self, forecasts: &'a [CertifiedForecast], clock: Clock) -> Vec<Moment<'a>> {
        let pairs = self.windows.iter().zip(forecasts).enumerate();
        let moments = pairs.map(|(i, (window, one))| Moment {
            scene: self.scenes.get(i).and_then(Option::as_ref),
            certified: (!one.certificates.is_empty()).then_some(one),
            ..Moment::new(window, &one.forecast, clock)
        });
        moments.collect()
    }
}

/// State that one chunk of forecasts passes on to the next.
#[derive(Debug, Default)]
pub(crate) struct StreamState {
    pub(crate) headed: bool,
    pub(crate) unfamiliar: UnfamiliarMotions,
    /// The coordinate frame that the tracks name.
    pub(crate) frame_id: Option<String>,
    told: BTreeSet<&'static str>,
    regions: BTreeMap<Option<SceneName>, AdaptiveRegions>,
}

impl StreamState {
    /// The forecast of window `i` with the adaptive regions of its scene.
    pub(crate) fn adapted(&mut self, windows: SceneWindows<'_>, i: usize, forecast: ddl::Forecast) -> ddl::Forecast {
        let scene = windows.scenes.get(i).cloned().flatten();
        self.regions.entry(scene).or_default().adapt(&windows.windows[i], forecast)
    }

    /// Whether nothing was written yet; only the first call says so.
    pub(crate) fn is_first_text(&mut self) -> bool {
        !std::mem::replace(&mut self.headed, true)
    }

    /// Tells something that is told once.
    pub(crate) fn tell_once(&mut self, what: &'static str, message: fmt::Arguments<'_>) {
        if self.told.insert(what) {
            tell(message);
        }
    }

    pub(crate) fn forget(&mut self, scene: &SceneName) {
        self.regions.remove(&Some(scene.clone()));
    }
}

/// Stable steps keep the guarantee for any output of the network. If one violates it, a user who relies on the
/// forecasts must know.
pub(super) fn warn_of_violation(moments: &[Moment<'_>], state: &mut StreamState) {
    let first = moments.iter().find_map(|moment| {
        let (i, hypothesis, violation) = moment.certified?.first_violation()?;
        Some((moment, i, hypothesis, violation))
    });
    if let Some((moment, i, hypothesis, violation)) = first {
        state.tell_once(
            "violation",
            format_args!(
                "warning: not every certificate holds; the first that does not is that of pedestrian {}, observed \
                 until {}, hypothesis {hypothesis}: {violation}",
                moment.who(i),
                moment.when(),
            ),
        );
    }
}
