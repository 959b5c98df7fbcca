//! A user's own tracks, as in `ddl forecast`: format guessed, rate given, windows cut.

use ddl_core::{COORDINATE_LIMIT, OBSERVED};
use ddl_data::{Clock, Completeness, Format, Recording, WindowRule, parse_recording};

use super::tracks::bounded;

const NAMES: [&str; 4] = ["a.csv", "a.txt", "a.ndjson", "a"];
/// Seconds per frame; the second byte chooses one.
const FRAME_TIMES: [f64; 6] = [0.4, 0.04, 1.0 / 30.0, 0.1, 1e-9, 7.0];

/// Limit of positions before the first row (m): a runner is there seconds earlier.
const UNSEEN_LIMIT: f64 = COORDINATE_LIMIT + 1000.0;

/// The first byte chooses the name of a file of tracks, the second the rate; the others are its content.
pub(super) fn read(bytes: &[u8]) {
    let [name, rate, text @ ..] = bytes else {
        return;
    };
    let name = NAMES[usize::from(*name) % NAMES.len()];
    let Ok(format) = Format::guess(name.as_ref(), text, &ddl_data::ColumnChoice::default()) else {
        return;
    };
    let Ok(recording) = parse_recording(text, name, format) else {
        return;
    };
    cut(&recording);
    let frame_time = FRAME_TIMES[usize::from(*rate) % FRAME_TIMES.len()];
    let clock = recording.stated_clock().unwrap_or_else(|| Clock::with_frame_time(frame_time));
    if let Ok(recording) = clock.and_then(|clock| recording.on_clock(clock)) {
        bounded(&recording);
        cut(&recording);
    }
}

fn cut(recording: &Recording) {
    let last = recording.frames().last().copied();
    let whole = recording.observed_windows();
    let partial = recording.observe(recording.live_tracks().with_completeness(Completeness::Partial)).windows;
    assert!(whole.len() <= partial.len() && partial.len() <= recording.frames().len());
    for window in &partial {
        assert_eq!(window.steps(), OBSERVED);
        assert!(window.frames().last() <= last.as_ref());
        for i in 0..window.len() {
            let mut far = window.observed(i).as_flattened().iter();
            assert!(far.all(|c| c.abs() <= UNSEEN_LIMIT), "{window:?}");
        }
    }
    for rule in [
        WindowRule::Published,
        WindowRule::Complete,
        WindowRule::Observed,
        WindowRule::SocialGan { min_pedestrians: 2 },
    ] {
        assert!(recording.windows(rule).len() <= recording.frames().len());
    }
}
