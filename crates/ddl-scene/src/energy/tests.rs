#![expect(clippy::float_cmp, reason = "constants are passed on with their bits")]

use super::*;
use crate::fixture::energy;
use std::f32::consts::SQRT_2;

fn agree(found: f32, expected: f32) {
    assert!((found - expected).abs() < 1e-4 * expected.max(1.0), "{found} {expected}");
}

/// Present distance and radius (m), strength, distances with their energies.
type Conflicts = ([f64; 2], f32, &'static [[f32; 2]]);

/// Knots at 0, 0.2, 0.4, 0.6, 0.8 and 1 m from the edge, straight lines between them.
#[test]
fn conflicts_by_hand() {
    let cases: [Conflicts; 5] = [
        ([3.0, 0.0], 0.0, &[[0.0, 1.6], [0.05, 1.4], [0.3, 0.6], [0.7, 0.15], [0.9, 0.05], [7.0, 0.0]]),
        // A radius of 0.7 m.
        ([3.0, 0.7], 0.0, &[[0.2, 1.6], [0.7, 1.6], [0.9, 0.8], [1.0, 0.6], [1.6, 0.05], [1.7, 0.0]]),
        // Two who are 0.9 m apart are 0.2 m from that edge: a conflict begins there for them, or at 0.1 m.
        ([0.9, 0.7], 0.0, &[[0.7, 1.6], [0.8, 0.8], [0.9, 0.4], [1.1, 0.1]]),
        ([0.7, 0.7], 0.0, &[[0.7, 1.6], [0.75, 0.8], [0.8, 0.4]]),
        ([3.0, 0.0], 1e-3, &[[0.0, 3.1], [0.1, 2.3], [0.4, 0.7], [0.7, 0.4]]),
    ];
    let reaches = cases.map(|(at, strength, conflicts)| {
        let pair = energy().of_pair(at, 0.2, strength, 2.0);
        for &[distance, expected] in conflicts {
            agree(pair.conflict(distance), expected);
        }
        assert_eq!(pair.is_together(), strength > 0.0);
        pair.reach()
    });
    for (found, expected) in reaches.into_iter().zip([1.0, 1.7, 1.2, 0.95, 1.0]) {
        agree(found, expected);
    }
    // Halfway from 0.2 to 0.8 the distance is 0.3 m, from there on 0.2 m.
    for (crowding, kept, expected) in [(0.5, 3.0, 0.3), (0.8, 3.0, 0.2), (1.0, 3.0, 0.2), (0.5, 0.25, 0.25)] {
        agree(energy().of_pair([kept, 0.0], crowding, 0.0, 0.0).near, expected);
    }
    assert_eq!((energy().reach(), energy().together_within()), (1.0, 4.0));
}

/// Divided by the root of the partners: in a group of three each has two.
#[test]
fn walking_apart_by_hand() {
    for (partners, divisor) in [(0.0, 1.0), (1.0, 1.0), (2.0, SQRT_2), (4.0, 2.0)] {
        let [together, strangers] = [6.0, 0.0].map(|strength| energy().of_pair([3.0, 0.0], 0.0, strength, partners));
        // 3 scale² is 0.75 m²: ln(1 + 2.25 / 0.75) = ln 4.
        agree(together.apart(2.25), 6.0 * 4.0_f32.ln() / divisor);
        agree(together.apart(0.0) + strangers.apart(2.25), 0.0);
    }
}

/// Who walks together, by the mean distance over the observation and the difference of the mean velocities.
#[test]
fn strengths_by_hand() {
    // The second is `apart` metres aside on average, and `faster` (m/s) on both axes in the ratio 3 to 4.
    let strength = |apart: f64, faster: f64| {
        let time = |t: usize| 0.4 * t as f64 - 1.4;
        let walk = |side: f64, [vx, vy]: Position| -> [Position; 8] {
            std::array::from_fn(|t| [vx * time(t) - 0.8 * side, vy * time(t) + 0.6 * side])
        };
        let other = walk(apart, [0.3 + 0.6 * faster, -1.1 + 0.8 * faster]);
        energy().strength(closeness(&walk(0.0, [0.3, -1.1]), &other))
    };
    let distances = [0.8, 1.8, 3.7].map(|apart| [0.05, 0.25, 0.5].map(|faster| strength(apart, faster)));
    assert_eq!(distances, [[0.9, 0.8, 0.7], [0.6, 0.5, 0.4], [0.3, 0.2, 0.1]]);
    assert_eq!([strength(4.1, 0.0), strength(0.5, 0.61)], [0.0, 0.0]);
    assert_eq!([strength(0.99, 0.09), strength(1.01, 0.11)], [0.9, 0.5]);
    // One who comes nearer by 1.4 m: neither the first distance counts nor the last.
    for (last, expected) in [(0.0, 0.7), (0.6, 0.4)] {
        let line = |[x, y]: Position, step: f64| (0..8).map(|t| [x, y + step * f64::from(t)]).collect::<Vec<_>>();
        let (still, nearing) = (line([0.0; 2], 0.0), line([0.2, last + 1.4], -0.2));
        assert_eq!(energy().strength(closeness(&still, &nearing)), expected);
    }
}

#[test]
fn avoidance_by_hand() {
    let (energy, e) = (energy(), std::f64::consts::E);
    // Within, present distance (m), share of those who let others come near, logarithm.
    for [within, present, crowding, expected] in [
        [0.0, 2.0, 0.0, 3.0],
        [0.4, 2.0, 0.0, 2.0],
        [0.8, 2.0 * e, 0.0, 0.75 * 1.4],
        [0.6, 2.0, 0.5, 0.6],
        [1.5, 99.0, 0.0, 0.25 * (1.0 + 0.4 * 5.0_f64.ln())],
        [0.6, 0.1, 0.9, 0.0],
        [9.0, 2.0, 0.0, 0.0],
    ] {
        let found = energy.avoidance_of_stranger(within, present, crowding);
        assert!((found - expected).abs() < 1e-9, "{within} {present} {crowding}: {found}");
    }
    // Within, distance kept from the ego, logarithm.
    for [within, kept, expected] in
        [[0.5, 0.5, 0.5], [0.5, 0.5 * e, 2.5], [1.0, 9.0, 2.5], [0.5, 0.4, 0.5 + 2.0 * 0.8_f64.ln()], [0.5, 0.0, 0.0]]
    {
        let found = energy.avoidance_of_companion(within, kept);
        assert!((found - expected).abs() < 1e-9, "{within} {kept}: {found}");
    }
}
