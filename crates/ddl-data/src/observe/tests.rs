//! Observations estimated from the rows of a track.

use ddl_core::{Position, distance};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

use crate::observe::estimate::Observed;
use crate::observe::{ObservedTrack, RecordingNoise, Row};

fn observed(rows: &[(f64, Position)], time: f64) -> Observed {
    let mut noise = RecordingNoise::default();
    let mut track = ObservedTrack::beginning(rows[0].0, rows[0].1);
    for &(time, position) in &rows[1..] {
        track.forget_before(time, 0.4);
        track.push(Row { time, position }, 1.0, &noise.clone(), &mut noise);
    }
    track.observed(time, 0.4, 1.0, &noise).unwrap()
}

fn walk(times: impl Iterator<Item = f64>) -> Vec<(f64, Position)> {
    times.map(|time| (time, [1.3 * time, 2.0 - 0.4 * time])).collect()
}

fn noisy(rows: &[(f64, Position)], deviation: f64, seed: u64) -> Vec<(f64, Position)> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, deviation).unwrap();
    let moved = rows
        .iter()
        .map(|&(time, position)| (time, position.map(|coordinate| coordinate + normal.sample(&mut random))));
    moved.collect()
}

fn bits(position: Position) -> [u64; 2] {
    position.map(f64::to_bits)
}

fn farthest(a: &[Position], b: &[Position]) -> f64 {
    let distances = a.iter().zip(b).map(|(a, b)| distance(*a, *b));
    distances.fold(0.0, f64::max)
}

/// The posterior of a Gaussian process whose velocity is a Wiener process (spectral density 0.02, variance 2 at the
/// first row, noise 0.02), solved as one system of equations with numpy 2.4. The moment is 0.1 s after the last row,
/// the first position 0.05 s before the first row. Of eight rows 0.4 s apart the last position has the deviation
/// 0.01842525, and the velocity 0.07588693; the quality says what is more.
#[test]
fn an_estimate_is_the_posterior_of_a_gaussian_process() {
    let times = [0.35, 0.8, 1.3, 1.7, 2.25, 2.7, 3.0];
    let x = [0.4, 1.05, 1.7, 2.2, 2.9, 3.4, 3.85];
    let y = [0.02, 0.01, 0.1, 0.22, 0.35, 0.6, 0.75];
    let mut rows: Vec<(f64, Position)> = (0..7).map(|row| (times[row], [x[row], y[row]])).collect();
    let expected = [
        [0.339_103_04, 0.005_920_05],
        [0.900_018_33, 0.019_085_18],
        [1.439_247_79, 0.065_044_14],
        [1.953_425_81, 0.149_307_58],
        [2.453_070_23, 0.257_257_86],
        [2.943_801_59, 0.398_223_53],
        [3.4, 0.6], // the row at this step
        [3.961_300_49, 0.797_607_14],
    ];
    let Observed { positions, quality } = observed(&rows, 3.1);
    assert!(farthest(&positions, &expected) < 1e-6, "{positions:?}");
    let expected = [0.1, 0.013_558_69, 0.046_221_88];
    let found = [quality.age, quality.deviation, quality.velocity_deviation];
    assert!(
        found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6),
        "{quality:?}"
    );
    assert_eq!(quality.unseen, 1);
    // A row on its step passes unchanged, and so does one 2 ms beside it.
    rows.push((3.099, [4.0, 0.8]));
    assert_eq!(bits(observed(&rows, 3.1).positions[7]), bits([4.0, 0.8]));
}

/// A hundred pedestrians at 10 rows a second: the noise that is measured is the noise that was added.
#[test]
fn noise_is_measured() {
    for (added, measured) in [
        (0.0, 0.005..0.021),
        (0.05, 0.04..0.06),
        (0.1, 0.09..0.15),
        (0.2, 0.14..0.29),
    ] {
        let mut noise = RecordingNoise::default();
        for seed in 0..100 {
            let rows = noisy(&walk((0..30).map(|k| 0.1 * f64::from(k))), added, seed);
            let mut track = ObservedTrack::beginning(rows[0].0, rows[0].1);
            for &(time, position) in &rows[1..] {
                track.push(Row { time, position }, 1.0, &noise.clone(), &mut noise);
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
        track.push(Row { time, position }, 1.0, &noise.clone(), &mut noise);
        track.forget_before(time, 0.4);
        assert!(track.rows.len() <= 2300, "{}", track.rows.len());
        let observed = track.observed(time, 0.4, 1.0, &noise);
        assert!(
            time < 2.81 || observed.is_some_and(|observed| observed.quality.is_whole()),
            "{time}"
        );
    }
    let last = rows[rows.len() - 1].0;
    let expected = walk((0..8).map(|place| last - 0.4 * f64::from(7 - place)));
    let expected: Vec<Position> = expected.into_iter().map(|(_, position)| position).collect();
    let found = track.observed(last, 0.4, 1.0, &noise).unwrap().positions;
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
        let moved = second
            .into_iter()
            .map(|(time, [x, y])| (time, [x + jump[0], y + jump[1]]));
        let moved: Vec<_> = moved.collect();
        let seen = observed(&[first, moved].concat(), again + 5.0 * interval);
        let [.., before, last] = seen.positions;
        let speed = distance(before, last) / 0.4;
        assert!((1.3..1.45).contains(&speed), "{interval} {gap} {jump:?}: {speed} m/s");
        let earliest = distance(seen.positions[0], last) / 2.8;
        assert!(
            (1.3..1.45).contains(&earliest),
            "{interval} {gap} {jump:?}: {earliest} m/s"
        );
    }
}
