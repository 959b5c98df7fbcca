//! The state that one group of frames passes on to the next.

use crate::telling::tell;
use ddl::{Moment, UnfamiliarMotions};
use std::collections::BTreeSet;
use std::fmt;

/// State that one chunk of forecasts passes on to the next.
#[derive(Debug, Default)]
pub(crate) struct StreamState {
    pub(crate) headed: bool,
    pub(crate) unfamiliar: UnfamiliarMotions,
    /// The coordinate frame that the tracks name.
    pub(crate) frame_id: Option<String>,
    told: BTreeSet<&'static str>,
}

impl StreamState {
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

    /// Stable steps keep the guarantee for any output of the network. If one violates it, a user who relies on the
    /// forecasts must know.
    pub(super) fn warn_of_violation(&mut self, moments: &[Moment<'_>]) {
        let first = moments.iter().find_map(|moment| Some((moment, moment.answer.first_violation()?)));
        if let Some((moment, (i, hypothesis, violation))) = first {
            let (who, when) = (moment.who(i), moment.when());
            self.tell_once(
                "violation",
                format_args!(
                    "warning: not every certificate holds; the first that does not is that of pedestrian {who}, \
                     observed until {when}, hypothesis {hypothesis}: {violation}"
                ),
            );
        }
    }
}
