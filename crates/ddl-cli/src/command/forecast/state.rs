//! The state that one group of frames passes on to the next, and what is told once of a stream.

use crate::command::forecast::frames::StatedTime;
use crate::command::forecast::plans::PlanFile;
use crate::telling::tell;
use crate::units::Units;
use ddl::data::{Clock, LiveTracks};
use ddl::{Moment, Note, UnfamiliarMotions};
use std::collections::BTreeSet;
use std::fmt;

/// Number of frames that show whether pedestrians have common ones.
const MANY_FRAMES: u64 = 200;

/// State that one chunk of forecasts passes on to the next.
#[derive(Debug, Default)]
pub(crate) struct StreamState {
    pub(crate) headed: bool,
    pub(crate) unfamiliar: UnfamiliarMotions,
    /// The coordinate frame that the tracks name.
    pub(crate) frame_id: Option<String>,
    told: BTreeSet<&'static str>,
    /// What was told of the present plans.
    told_of_plans: BTreeSet<&'static str>,
    /// The plans of the command, if it has some.
    pub(crate) plans: PlanFile,
}

impl StreamState {
    /// Whether nothing was written yet; only the first call says so.
    pub(crate) fn is_first_text(&mut self) -> bool {
        !std::mem::replace(&mut self.headed, true)
    }

    /// Tells remarks of which one of each kind is told, at this moment for the first time.
    pub(crate) fn tell_notes_once(&mut self, notes: impl IntoIterator<Item = Note>, moment: &Moment<'_>) {
        // What is doubtful of other plans is told again.
        if self.plans.take_changed() {
            self.told_of_plans.clear();
        }
        for note in notes {
            if self.told_of_plans.insert(note.key()) {
                tell(format_args!("{}, at {} (told once)", note.line(), moment.when()));
            }
        }
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

    /// Tells of a comment that gives another rate than the option.
    pub(super) fn tell_other_rate(&mut self, units: &Units, stated: &StatedTime) {
        if let (Some(rate), Some(option)) = (stated.frame_rate, units.rate_given())
            && units.live_clock().ok().flatten() != Clock::with_frame_time(rate.recip()).ok()
        {
            let note = format_args!("note: read as {option}, although the input says {rate} frames a second");
            self.tell_once("rate", note);
        }
    }

    /// Tells of noise and of clocks of the pedestrians' own, after a number of frames.
    pub(super) fn tell_doubts(&mut self, tracks: &LiveTracks, frames: u64, are_thinned: bool) {
        if let Some(note) = ddl::noise(tracks.noise().metres()) {
            self.tell_once("noise", format_args!("{}", note.line()));
        }
        if frames >= MANY_FRAMES && !are_thinned && !tracks.have_common_frames() {
            self.tell_once(
                "clocks",
                format_args!(
                    "note: each pedestrian has a clock of its own, and all are forecast from every row; --every 0.4 \
                     (of occupancy --moments-every) makes a forecast every 0.4 s, as of a file"
                ),
            );
        }
    }
}
