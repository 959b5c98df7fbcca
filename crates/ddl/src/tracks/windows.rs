//! The windows that a user asks for.

use ddl_data::{Completeness, LiveTracks};

/// These tracks with windows of all pedestrians, or only of those tracked for the `whole` 8 steps; of `every` moment so
/// many seconds apart, or only of the `last` one. Pedestrians are carried on until `max_age` seconds. `None` stands for
/// what suits the recording.
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
            return Err(format!(
                "{name} is {seconds}; it must be a number of seconds from 0 to {longest}"
            ));
        }
    }
    // With clocks of their own, too, the last row is the last moment.
    let every = every.or(last.then_some(0.0));
    let tracks = tracks.with_completeness(Completeness::of(whole));
    Ok(tracks.with_max_age(max_age).with_interval(every))
}
