//! The windows that a user asks for.

use ddl_data::{Completeness, LiveTracks};

/// These tracks with the options of their windows. `whole`: only pedestrians tracked for all 8 steps. `max_age`: the
/// age of the last row (s) up to which a pedestrian is carried on. `every`: the time between two windows (s). `last`:
/// only the last window is wanted. `None`: the default of [`LiveTracks`].
///
/// # Errors
/// When seconds are out of range.
pub fn windows_of(
    tracks: LiveTracks,
    whole: bool,
    [max_age, every]: [Option<f64>; 2],
    last: bool,
) -> Result<LiveTracks, String> {
    let longest = LiveTracks::LONGEST_GAP;
    for (name, seconds) in [("max_age", max_age), ("every", every)] {
        if let Some(seconds) = seconds.filter(|seconds| !(0.0..=longest).contains(seconds)) {
            return Err(format!("{name} is {seconds}; it must be a number of seconds from 0 to {longest}"));
        }
    }
    // With clocks of their own, too, the last row is the last moment.
    let every = every.or(last.then_some(0.0));
    let tracks = tracks.with_completeness(Completeness::of(whole));
    Ok(tracks.with_max_age(max_age).with_interval(every))
}
