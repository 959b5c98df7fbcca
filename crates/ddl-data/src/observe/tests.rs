//! Observations estimated from the rows of a track; their numbers are those of `tests/laws/observe_reference.rs`.

use ddl_core::{Position, distance};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

use crate::observe::estimate::ObservedPositions;
use crate::observe::{ObservedTrack, RecordingNoise, TimedPosition};

fn observed(rows: &[(f64, Position)], time: f64) -> ObservedPositions {
    let mut noise = RecordingNoise::default();
    let mut track = ObservedTrack::beginning(rows[0].0, rows[0].1);
    for &(time, position) in &rows[1..] {
        track.forget_before(time, 0.4);
        track.push(TimedPosition { time, position }, 1.0, &mut noise);
    }
    track.observed(time, 0.4, 1.0).unwrap()
}

fn walk(times: impl Iterator<Item = f64>) -> Vec<(f64, Position)> {
    times.map(|time| (time, [1.3 * time, 2.0 - 0.4 * time])).collect()
}

fn noisy(rows: &[(f64, Position)], deviation: f64, seed: u64) -> Vec<(f64, Position)> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, deviation).unwrap();
    let moved =
        rows.iter().map(|&(time, position)| (time, position.map(|coordinate| coordinate + normal.sample(&mut random))));
    moved.collect()
}

fn farthest(a: &[Position], b: &[Position]) -> f64 {
    a.iter().zip(b).map(|(a, b)| distance(*a, *b)).fold(0.0, f64::max)
}

/// A hundred pedestrians at 10 rows a second: the noise that is measured is the noise that was added.
#[test]
fn noise_is_measured() {
    for (added, measured) in [(0.0, 0.005..0.021), (0.05, 0.04..0.06), (0.1, 0.09..0.15), (0.2, 0.14..0.29)] {
        let mut noise = RecordingNoise::default();
        for seed in 0..100 {
            let rows = noisy(&walk((0..30).map(|k| 0.1 * f64::from(k))), added, seed);
            let mut track = ObservedTrack::beginning(rows[0].0, rows[0].1);
            for &(time, position) in &rows[1..] {
                track.push(TimedPosition { time, position }, 1.0, &mut noise);
            }
        }
        assert!(measured.contains(&noise.metres()), "{added}: {}", noise.metres());
    }
}

proptest! {
    /// A turned and moved track has a turned and moved estimate, at any clock.
    #[test]
    fn estimates_move_with_their_track(
        gaps in prop::collection::vec(0.02..0.9, 5..30),
        steps in prop::collection::vec(prop::array::uniform2(-0.3..0.3), 30),
        angle in 0.0..6.3_f64,
        offset in prop::array::uniform2(-50.0..50.0),
        age in 0.01..0.3,
    ) {
        let (mut time, mut position) = (0.0, [0.0, 0.0]);
        let rows: Vec<(f64, Position)> = gaps.iter().zip(&steps).map(|(gap, step)| {
            time += gap;
            position = [position[0] + gap + step[0] * gap, position[1] + step[1] * gap];
            (time, position)
        }).collect();
        let (sin, cos) = angle.sin_cos();
        let turn = |p: Position| [cos * p[0] - sin * p[1] + offset[0], sin * p[0] + cos * p[1] + offset[1]];
        let turned: Vec<_> = rows.iter().map(|&(time, position)| (time, turn(position))).collect();
        let (here, there) = (observed(&rows, time + age), observed(&turned, time + age));
        prop_assert!(farthest(&here.positions.map(turn), &there.positions) < 1e-9);
        let [less, more, later] = [here, there, observed(&rows, time + age + 0.1)].map(|seen| seen.quality);
        prop_assert!((less.deviation - more.deviation).abs() < 1e-9 && less.unseen == more.unseen);
        // The longer ago, the less certain; what is as certain as with eight rows has no deviation.
        prop_assert!(later.deviation > less.deviation || later.deviation == 0.0);
        prop_assert!(later.velocity_deviation > less.velocity_deviation || later.velocity_deviation == 0.0);
    }
}

/// Of a thousand rows a second those are kept that show something, the first ones too.
#[test]
fn the_rows_that_are_kept_are_bounded() {
    let rows = walk((0..10_000).map(|row| 1e-3 * f64::from(row)));
    let mut noise = RecordingNoise::default();
    let mut track = ObservedTrack::beginning(rows[0].0, rows[0].1);
    for &(time, position) in &rows[1..] {
        track.push(TimedPosition { time, position }, 1.0, &mut noise);
        track.forget_before(time, 0.4);
        assert!(track.rows.len() <= 2300, "{}", track.rows.len());
        let observed = track.observed(time, 0.4, 1.0);
        assert!(time < 2.81 || observed.is_some_and(|observed| observed.quality.is_whole()), "{time}");
    }
    let last = rows[rows.len() - 1].0;
    let expected = walk((0..8).map(|place| last - 0.4 * f64::from(7 - place)));
    let expected: Vec<Position> = expected.into_iter().map(|(_, position)| position).collect();
    let found = track.observed(last, 0.4, 1.0).unwrap().positions;
    assert!(farthest(&found, &expected) < 0.01, "{found:?}");
}

/// If another pedestrian takes over an id, after a gap or at once, a new track begins with the speed of the new
/// pedestrian (1.36 m/s). The last case is the same pedestrian after a gap.
#[test]
fn rows_that_go_on_from_a_jump_are_another_track() {
    for (interval, gap, jump) in [
        (0.4, 0.4, [0.0, 1.6]),
        (0.4, 0.4, [1.2, 0.0]),
        (0.2, 0.2, [1.0, 0.0]),
        (0.1, 0.1, [0.0, 0.8]),
        (0.1, 0.8, [2.0, 0.0]),
        (0.1, 1.2, [3.0, 0.0]),
        (0.1, 1.5, [3.0, 0.0]),
        (0.1, 1.8, [0.0, 5.0]),
        (0.1, 1.8, [0.0, 0.0]),
    ] {
        let first = walk((0..20).map(|k| interval * f64::from(k)));
        let again = first[19].0 + gap;
        let second = walk((0..6).map(|k| again + interval * f64::from(k)));
        let moved: Vec<_> = second.into_iter().map(|(time, [x, y])| (time, [x + jump[0], y + jump[1]])).collect();
        let seen = observed(&[first, moved].concat(), again + 5.0 * interval);
        let [.., before, last] = seen.positions;
        let speed = distance(before, last) / 0.4;
        assert!((1.3..1.45).contains(&speed), "{interval} {gap} {jump:?}: {speed} m/s");
        let earliest = distance(seen.positions[0], last) / 2.8;
        assert!((1.3..1.45).contains(&earliest), "{interval} {gap} {jump:?}: {earliest} m/s");
    }
}
