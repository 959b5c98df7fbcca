//! Rows that people seldom make, in live tracks.

use ddl_core::{OBSERVED, PedestrianId, distance};
use ddl_data::{Clock, Completeness, LiveTracks, Misfit, MisfitTreatment};

/// Somebody who stands or walks, seen off its place once: until the next row both explanations count, then the row is
/// left out. Steps that people make are facts.
#[test]
fn a_doubtful_row_has_two_explanations_until_the_next() {
    for rate in [2.5, 5.0, 10.0, 25.0, 30.0] {
        for (speed, off) in [(0.0, 0.2), (0.0, 0.5), (1.2, 0.2), (1.2, 0.5)] {
            let wrong = (4.0 * rate) as i64;
            let mut tracks = LiveTracks::with_clock(Clock::with_frame_time(1.0 / rate).unwrap())
                .with_completeness(Completeness::Partial);
            for frame in 0..=wrong + 1 {
                let place = [speed * frame as f64 / rate, if frame == wrong { off } else { 0.0 }];
                let window = tracks.push(frame, [(PedestrianId(1), place)]).unwrap();
                let Some(window) = window else { continue };
                let other = window.other(0);
                assert_eq!(other.is_some(), frame == wrong, "{rate} {speed} {off}: {frame} of {wrong}");
                let Some(other) = other else { continue };
                let [row, expected] = [window.observed(0)[OBSERVED - 1], other.positions[OBSERVED - 1]];
                let (row, expected, weight) = match window.quality(0).age {
                    0.0 => (row, expected, other.weight),
                    _ => (expected, row, 1.0 - other.weight),
                };
                assert!(distance(row, place) < 1e-12);
                assert!(distance(expected, [place[0], 0.0]) < 0.02, "{rate} {speed} {off}: {expected:?}");
                // From 10 m/s² on the row is worth nearly nothing.
                let least = if off * rate * rate > 15.0 { 0.94 } else { 0.7 };
                assert!((least..0.96).contains(&weight), "{rate} {speed} {off}: {weight}");
                assert!(window.quality(0).uncertainty() > 0.1);
            }
            let told = tracks.misfits();
            assert!(
                matches!(told, [Misfit { treatment: MisfitTreatment::LeftOut, .. }]),
                "{rate} {speed} {off}: {told:?}"
            );
        }
        // A start at 1 m/s².
        let mut tracks = LiveTracks::with_clock(Clock::with_frame_time(1.0 / rate).unwrap());
        for frame in 0..(8.0 * rate) as i64 {
            let time = (frame as f64 / rate - 5.0).max(0.0);
            let way = if time < 1.4 { 0.5 * time * time } else { 0.98 + 1.4 * (time - 1.4) };
            tracks.push(frame, [(PedestrianId(1), [way, 0.0])]).unwrap();
            assert_eq!(tracks.misfits(), []);
        }
    }
}

/// Somebody who stands is seen off its place twice, the second time where nobody can be: that row decides nothing about
/// the first one, and the next right row shows that both are wrong.
#[test]
fn a_row_that_is_left_out_decides_nothing() {
    for rate in [2.5, 10.0, 30.0] {
        let mut tracks = LiveTracks::with_clock(Clock::with_frame_time(1.0 / rate).unwrap())
            .with_completeness(Completeness::Partial);
        let first = (4.0 * rate) as i64;
        let mut told = Vec::new();
        for frame in 0..=first + 2 {
            let x = [0.4, 4.0].get((frame - first) as usize).copied().unwrap_or(0.0);
            let window = tracks.push(frame, [(PedestrianId(1), [x, 0.0])]).unwrap().unwrap();
            told.extend(tracks.misfits().iter().map(|misfit| misfit.treatment));
            assert_eq!(window.other(0).is_some(), [first, first + 1].contains(&frame), "{rate}: {frame} of {first}");
            assert!(frame < first + 2 || distance(window.observed(0)[OBSERVED - 1], [0.0; 2]) < 0.02);
        }
        assert_eq!(told, [MisfitTreatment::LeftOut; 2], "{rate}");
    }
}
