use super::*;
use crate::fixture::{energy, hypotheses, pedestrians, scene, walk};
use crate::pairs::pairs_of;

/// The hypotheses that pedestrians follow in a future in which each was to follow its hypothesis 0.
fn followed(people: &str, plan: Option<Hypotheses>) -> Vec<usize> {
    let pedestrians = pedestrians(people);
    let (window, _) = scene(&pedestrians);
    let people: Vec<_> = hypotheses(&pedestrians).into_iter().chain(plan).collect();
    let known = |i: usize| (i < window.len()).then(|| walk(&window, i));
    let pairs = pairs_of(&energy(), &people, &(0..people.len()).map(known).collect::<Vec<_>>());
    let first = |one: &Hypotheses| [&[1.0], &vec![0.0; one.count() - 1][..]].concat();
    let mut shares: Vec<Vec<f32>> = people.iter().map(first).collect();
    let mut of_each: Vec<&mut [f32]> = shares.iter_mut().map(|shares| &mut shares[..]).collect();
    keep_apart(&people, &pairs, &mut of_each);
    let one = |shares: &Vec<f32>| shares.iter().position(|share| *share > 0.999).unwrap();
    assert!(shares.iter().all(|shares| shares.iter().sum::<f32>() < 1.001));
    shares[..pedestrians.len()].iter().map(one).collect()
}

/// One walks towards one who stands 2 m ahead. Two collide below 0.42 m, 1.05 times 0.4 m.
#[test]
fn the_nearest_way_that_is_free_is_taken() {
    let pair = |own: &str, others: &str| {
        let first = format!("0.5 0 0 1  0.4 0 1  0.3 {own}  0.3 0.3 0.9\n");
        followed(&(first + &format!("0.5 2 0 0  0.4 0 0  0.3 {others}  0.3 1 1")), None)
    };
    // (0.3, 0.9) passes 2 * 0.3 / 0.949 = 0.63 m aside, (0.2, 0.95) at 0.412 m, (0.21, 0.95) at 0.432 m. They are 0.32,
    // 0.21 and 0.22 m/s from the way ahead.
    assert_eq!(pair("1 1", "1 1"), [2, 0]);
    assert_eq!([pair("0.2 0.95", "1 1"), pair("0.21 0.95", "1 1")], [[2, 0], [1, 0]]);
    // Who stands walks out of the way at 0.2 or 0.22 m/s: the other one passes at 0.392 or 0.43 m.
    assert_eq!([pair("1 1", "-0.2 0"), pair("1 1", "-0.22 0")], [[2, 0], [0, 1]]);
    // A way of the probability 0 is none.
    assert_eq!(followed("0 0 0 1  1 0 1  0 0.3 0.9\n0 2 0 0  1 0 0  0 1 1", None), [0, 0]);
    // A plan that stands 1 m aside of the way ahead: a radius of 0.5 m is not in the way, one of 0.6 m is.
    for (radius, expected) in [(0.5, 0), (0.6, 1)] {
        let plan = Hypotheses::certain([1.0, 2.0], &[[1.0, 2.0]; HORIZON], radius);
        let found = followed("0 0 0 1  0.5 0 1  0.5 -0.3 0.9", Some(plan));
        assert_eq!(found, [expected], "{radius}");
    }
}

#[test]
fn a_collision_within_the_first_step_counts_and_one_of_now_does_not() {
    // 3 m/s: past somebody 0.6 m ahead before the first step; 0.3 m ahead they touch already.
    for (x, expected) in [(2.6, 1), (2.3, 0)] {
        let people = format!("2 1 3 0  0.5 3 0  0.5 2 2.5\n{x} 1 0 0  0.5 0 0  0.5 0 0");
        assert_eq!(followed(&people, None), [expected, 0], "{x}");
    }
}

/// Two stand on the way ahead, one on the next best, none on the third. Without the third, the one on the next best
/// gives way.
#[test]
fn the_way_with_the_fewest_collisions_is_taken() {
    let others = "0 2 0 0  0.4 0 0  0.3 1 1  0.3 1 1\n0 4 0 0  0.4 0 0  0.3 1 1  0.3 1 1\n\
                  1.2 3.6 0 0  0.4 0 0  0.3 0.3 -0.1  0.3 0.3 -0.1";
    for (third, expected) in [("-0.5 0.9", [2, 0, 0, 0]), ("0 1", [1, 0, 0, 1])] {
        let people = format!("0 0 0 1  0.4 0 1  0.3 0.3 0.9  0.3 {third}\n{others}");
        assert_eq!(followed(&people, None), expected);
    }
}

#[test]
fn least_distances_by_hand() {
    let squares =
        [([3.0, 1.0], [-1.0, 1.0]), ([3.0, 4.0], [3.0, 5.0]), ([2.0, 3.0], [1.0, -1.0]), ([0.5, -2.0], [0.5, -2.0])];
    // At (0, 1), at the begin, at the end, and of one who stands.
    for ((from, to), expected) in squares.into_iter().zip([1.0, 25.0, 25.0 / 17.0, 4.25]) {
        assert!((least_squared(from, to) - expected).abs() < 1e-5, "{from:?} {to:?}");
        assert!((least_squared(to, from) - expected).abs() < 1e-5, "{from:?} {to:?}");
    }
}
