//! What is told once of a stream: its noise, clocks of its own, a rate that disagrees.

use crate::command::forecast::frames::StatedTime;
use crate::telling::tell;
use crate::units::Units;
use ddl::NOISY;
use ddl::data::LiveTracks;

/// Number of frames that show whether pedestrians have common ones.
const MANY_FRAMES: usize = 200;

/// What is told once of a stream.
#[derive(Debug, Default)]
pub(super) struct ToldOnce {
    rate: bool,
    noise: bool,
    clocks: bool,
    frames: usize,
}

impl ToldOnce {
    /// Tells of a comment that gives another rate than the option.
    pub(super) fn of_rate(&mut self, units: &Units, stated: &StatedTime) {
        if std::mem::replace(&mut self.rate, true) {
            return;
        }
        if let (Some(option), Some(rate)) = (units.rate_given(), stated.frame_rate)
            && option != format!("--fps {rate}")
        {
            tell(format_args!(
                "note: read as {option}, although a comment says {rate} frames a second"
            ));
        }
    }

    pub(super) fn of_tracks(&mut self, tracks: &LiveTracks, are_thinned: bool) {
        self.frames += 1;
        if tracks.noise().metres() >= NOISY && !std::mem::replace(&mut self.noise, true) {
            let noise = 100.0 * tracks.noise().metres();
            tell(format_args!(
                "note: the positions are noisy, {noise:.0} cm on each axis: observed paths are smoothed"
            ));
        }
        let have_own_clocks = self.frames >= MANY_FRAMES && !tracks.have_common_frames();
        if have_own_clocks && !are_thinned && !std::mem::replace(&mut self.clocks, true) {
            tell(format_args!(
                "note: each pedestrian has a clock of its own, and all are forecast from every row; --every 0.4 makes \
                 a forecast every 0.4 s, as of a file"
            ));
        }
    }
}
