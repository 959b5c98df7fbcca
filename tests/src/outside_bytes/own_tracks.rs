//! A user's own tracks, as in `ddl forecast`: format guessed, rate given, windows cut.

use ddl_data::{COORDINATE_LIMIT, Completeness, Format, OBSERVED, Recording, WindowRule, parse_recording};

use super::tracks::bounded;

const NAMES: [&str; 4] = ["a.csv", "a.txt", "a.ndjson", "a"];
/// Seconds per frame; the second byte chooses one.
const FRAME_TIMES: [f64; 6] = [0.4, 0.04, 1.0 / 30.0, 0.1, 1e-9, 7.0];

/// Limit of padded positions, m.
const PADDED_LIMIT: f64 = (1.0 + 6.0 * 2.0) * COORDINATE_LIMIT;

/// The first byte chooses the name of a file of tracks, the second the rate; the others are its content.
pub(super) fn read(bytes: &[u8]) {
    let [name, rate, text @ ..] = bytes else {
        return;
    };
    let name = NAMES[usize::from(*name) % NAMES.len()];
    let format = Format::guess(name.as_ref(), text);
    let Ok(recording) = parse_recording(text, name, format) else {
        return;
    };
    cut(&recording);
    let frame_time = FRAME_TIMES[usize::from(*rate) % FRAME_TIMES.len()];
    if let Ok(steps) = recording.resampled_to_steps(frame_time) {
        bounded(&steps.recording);
        cut(&steps.recording);
    }
}

fn cut(recording: &Recording) {
    let last = recording.frames().last().copied();
    let whole = recording.completed_windows(Completeness::Whole);
    let completed = recording.completed_windows(Completeness::Partial);
    assert!(whole.len() <= completed.len() && completed.len() <= recording.frames().len());
    for window in &completed {
        assert_eq!(window.steps(), OBSERVED);
        assert!(window.frames().last() <= last.as_ref());
        for i in 0..window.len() {
            // Up to 6 positions are padded at the start, on a straight line at the mean observed velocity: at most from
            // one end of the bound to the other in one step.
            let mut far = window.observed(i).as_flattened().iter();
            assert!(far.all(|c| c.abs() <= PADDED_LIMIT), "{window:?}");
        }
    }
    for rule in [
        WindowRule::Published,
        WindowRule::Complete,
        WindowRule::SocialGan { min_pedestrians: 2 },
    ] {
        assert!(recording.windows(rule).len() <= recording.frames().len());
    }
}
