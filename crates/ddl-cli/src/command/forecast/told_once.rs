//! What is told once of a stream: its noise, clocks of its own, a rate that disagrees.

use crate::command::forecast::frames::StatedTime;
use crate::command::forecast::state::StreamState;
use crate::units::Units;
use ddl::data::{Clock, LiveTracks};

/// Number of frames that show whether pedestrians have common ones.
const MANY_FRAMES: u64 = 200;

impl StreamState {
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
