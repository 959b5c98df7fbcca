//! Every metric of one window of three pedestrians with two hypotheses each, against numbers computed by hand.
//!
//! All offsets are sides of 3-4-5 triangles. Frames s = 1..12 are forecast; metres.
//!
//! ```text
//!    truth                     weight  hypothesis, as offset from the truth     ADE        FDE   goal
//! A  (3.5 + s/2, 0)            0.75    (0.24, 0.32)                             0.4        0.4   its end
//!                              0.25    s (0.06, 0.08), a straight line          0.65       1.2   2 steps farther
//! B  stands at (9.1, 2.56)     0.2     s (0.15, -0.2)                           1.625      3     0.5 m behind
//!                              0.8     (0.9, -1.2)                              1.5        1.5   its end
//! C  (12.5 - s/2, 0.3)         0.6     (0.72, 0.96)                             1.2        1.2   its end
//!                              0.4     (1.28, -0.96), and 0 at s = 12           17.6/12    0     its end
//! ```
//!
//! The mean of s is 6.5: 0.1 * 6.5 = 0.65 and 0.25 * 6.5 = 1.625.

use ddl_core::Forecast;
use ddl_data::{Convention, PedestrianId, Position, Window, WindowRule};
use ddl_eval::{Conditions, FutureCollisions, MotionKind, Protocol, ResultRow, Scores};

type Path = fn(f64) -> Position;

/// Positions of the three pedestrians at frame `s`, 0 being the last observed one.
const TRUTH: [Path; 3] = [|s| [3.5 + 0.5 * s, 0.0], |_| [9.1, 2.56], |s| [12.5 - 0.5 * s, 0.3]];

/// Offsets of the hypotheses from the truth at frame `s`.
const OFFSETS: [[Path; 2]; 3] = [
    [|_| [0.24, 0.32], |s| [0.06 * s, 0.08 * s]],
    [|s| [0.15 * s, -0.2 * s], |_| [0.9, -1.2]],
    [|_| [0.72, 0.96], |s| if s < 12.0 { [1.28, -0.96] } else { [0.0, 0.0] }],
];

fn hypothesis(i: usize, k: usize, s: f64) -> Position {
    let (p, d) = (TRUTH[i](s), OFFSETS[i][k](s));
    [p[0] + d[0], p[1] + d[1]]
}

fn scores() -> Scores {
    let tracks = TRUTH.map(|path| (0..20).map(|t| path(f64::from(t - 7))).collect());
    let ids = (0..3).map(PedestrianId).collect();
    let window = Window::new("made up", 0, 10, ids, tracks.into()).unwrap();
    let pairs = || (0..3).flat_map(|i| (0..2).map(move |k| (i, k)));
    let path = |(i, k)| (1..=12).map(move |s| hypothesis(i, k, f64::from(s)));
    let goals = pairs().map(|(i, k)| match (i, k) {
        // Two steps of (0.56, 0.08) beyond its end, on its line.
        (0, 1) => [3.5 + 14.0 * 0.56, 14.0 * 0.08],
        (1, 0) => [9.1 - 0.3, 2.56 + 0.4],
        _ => hypothesis(i, k, 12.0),
    });
    let weights = vec![0.75, 0.25, 0.2, 0.8, 0.6, 0.4];
    let forecast = Forecast::new(3, 2, pairs().flat_map(path).collect(), weights, Some(goals.collect()));
    let verdicts = vec![true, true, false, true, true, false];
    let forecast = forecast.unwrap().with_certified(verdicts).unwrap();
    let conditions = Conditions::new(Convention::Star, WindowRule::Complete, Protocol::Joint, "yard", "mine");
    ResultRow::score(conditions, &[window], &[forecast]).unwrap().scores
}

fn check(what: &str, actual: impl Into<Option<f64>>, expected: f64) {
    let actual = actual.into().unwrap();
    assert!(
        (actual - expected).abs() < 1e-12,
        "{what}: {actual}, by hand {expected}"
    );
}

#[test]
fn displacement_errors() {
    let s = scores();
    assert_eq!((s.pedestrians, s.windows, s.hypotheses), (3, 1, 2));
    // Least ADE: hypotheses 0, 1, 0. Least FDE: 0, 1, 1. The most likely are those of least ADE.
    let least = (0.4 + 1.5 + 1.2) / 3.0;
    check("minADE", s.min_ade, least);
    check("minFDE", s.min_fde, (0.4 + 1.5 + 0.0) / 3.0);
    check("FDE@minADE", s.fde_at_min_ade, least);
    let at_min_fde = (0.4 + 1.5 + 17.6 / 12.0) / 3.0;
    check("ADE@minFDE", s.ade_at_min_fde, at_min_fde);
    // Index 0 for all: ADE 3.225, FDE 4.6. Index 1: ADE 3.61666, FDE 2.7.
    check("JADE", s.joint_ade, (0.4 + 1.625 + 1.2) / 3.0);
    check("JFDE", s.joint_fde, (1.2 + 1.5 + 0.0) / 3.0);
    // A 0.3 + 0.1625, B 0.325 + 1.2, C 0.72 + 0.4 * 17.6 / 12.
    let expected = (0.4625 + 1.525 + 0.72 + 7.04 / 12.0) / 3.0;
    check("expected ADE", s.expected_ade, expected);
    // A 0.3 + 0.3, B 0.6 + 1.2, C 0.72 + 0.
    check("expected FDE", s.expected_fde, (0.6 + 1.8 + 0.72) / 3.0);
    check("most likely ADE", s.most_likely_ade, least);
    check("most likely FDE", s.most_likely_fde, least);
}

#[test]
fn misses_and_collisions() {
    let s = scores();
    // Nearest ends: 0.4, 1.5 and 0 m off.
    check("missed by 0.5 m", s.miss_rate, 1.0 / 3.0);
    check("missed by 1 m", s.miss_rate_1m, 1.0 / 3.0);
    check("missed by 2 m", s.miss_rate_2m, 0.0);
    // The representatives are the heavier of two hypotheses: A along y = 0.32, B at (10, 1.36), C along y = 1.26 from
    // x = 12.72 to 7.22. C passes B at 0.1 m; A stays 0.94 m from C and more than 1 m from B.
    check("collisions", s.collision_rate, 2.0 / 3.0);
    // In truth A and C pass each other at 0.3 m, and B is 2.26 m from C.
    check("true collisions", s.true_collision_rate, 2.0 / 3.0);
    // A (y = 0.32) against the true C (0.3): 0.02 m. B (1.36) against the true C: 1.06 m. C (1.26) against the true A
    // (0) and B (2.56): 1.26 and 1.3 m.
    let into_truth = s.true_neighbour_collision_rate;
    check("collisions with the truth", into_truth, 1.0 / 3.0);
}

#[test]
fn whole_futures() {
    let joint = scores().joint.unwrap();
    check("JADE of the window", joint.ade_windows, (0.4 + 1.625 + 1.2) / 3.0);
    check("JFDE of the window", joint.fde_windows, (1.2 + 1.5 + 0.0) / 3.0);
    // Future 0, the best: B meets C at 0.03 m, A stays 0.94 m from C and 1.17 m from B. Future 1: A passes B at 0.43 m.
    // In truth A and C pass each other at 0.3 m.
    for (found, truth) in [(joint.collisions, 2.0 / 3.0), (joint.close_collisions, 0.0)] {
        let FutureCollisions { mean, best, .. } = found;
        check("collisions, mean of the futures", mean, 1.0 / 3.0);
        check("collisions in the best future", best, 2.0 / 3.0);
        check("collisions in truth", found.truth, truth);
    }
}

#[test]
fn goals_and_stability() {
    let s = scores();
    check("goal FDE", s.goal_fde, (0.4 + 0.5 + 0.0) / 3.0);
    let stability = s.stability.unwrap();
    let degrees = |y: f64, x: f64| (y / x).atan().to_degrees();
    let turns = [
        // The first step is (0.74, 0.32), the goal is at (6.24, 0.32); from then on straight to it.
        degrees(0.32, 0.74) - degrees(0.32, 6.24),
        0.0,
        180.0,
        0.0,
        // The first step is (0.22, 0.96), the goal at (-5.28, 0.96): away from it at first.
        180.0 - degrees(0.96, 5.28) - degrees(0.96, 0.22),
        // (0.78, -0.96), the goal at (-6, 0).
        180.0 - degrees(0.96, 0.78),
    ];
    assert_eq!(stability.rollouts, 6);
    // Both of A, and the second of B, which is at its goal after one step.
    check("Phi falls", stability.decreasing, 0.5);
    // Two steps of sqrt(0.56^2 + 0.08^2) = sqrt(0.32); B's first: 3 m and the 0.5 m behind it.
    let to_goal = (2.0 * 0.32_f64.sqrt() + 3.5) / 6.0;
    check("to goal", stability.end_distance, to_goal);
    check("turn", stability.largest_turn, turns.iter().sum::<f64>() / 6.0);
    check("reversing", stability.reversing, 0.5);
    check("certified", stability.certified, 4.0 / 6.0);
}

#[test]
fn diversity() {
    let s = scores();
    // A: |0.4 - 0.1 s| is 4.2 in all; B: |0.25 s - 1.5| is 9 in all; C: right angle, legs 1.2 and 1.6, so 2 m for 11
    // frames and 1.2 m at the end.
    let path = (4.2 / 12.0 + 9.0 / 12.0 + 23.2 / 12.0) / 3.0;
    check("diversity", s.diversity, path);
    check("of the ends", s.end_diversity, (0.8 + 1.5 + 1.2) / 3.0);
}

/// Numbers of `hand_example()` in `tests/reference/distribution.py` (numpy 2.4.6, scipy 1.17.1), which repeats the
/// offsets and computes with matrices.
#[test]
fn the_distribution_as_computed_elsewhere() {
    let s = scores();
    check("KDE NLL", s.kde_nll, 8.296_237_304_878_993);
    // Computed with 40 digits: across the line of the two hypotheses the deviation is only 1 cm, which magnifies
    // rounding errors.
    check("AMD", s.amd, 37.879_277_080_741_79);
    check("AMV", s.amv, 0.336_472_522_377_543_5);
}

#[test]
fn categories() {
    // minADE, minFDE, ADE in future 0, FDE in future 1.
    let walking = [0.8, 0.2, 0.8, 0.6];
    let standing = [1.5, 1.5, 1.625, 1.5];
    let by_hand = [(MotionKind::Standing, 1, standing), (MotionKind::Straight, 2, walking)];
    let categories = scores().categories;
    assert_eq!(categories.len(), by_hand.len());
    for (c, (category, pedestrians, by_hand)) in categories.iter().zip(by_hand) {
        assert_eq!((c.category, c.pedestrians), (category, pedestrians));
        let categories = [c.min_ade, c.min_fde, c.joint_ade.unwrap(), c.joint_fde.unwrap()];
        for (actual, by_hand) in categories.into_iter().zip(by_hand) {
            check(&category.to_string(), actual, by_hand);
        }
    }
}
