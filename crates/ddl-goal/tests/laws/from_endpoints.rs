//! Goals from given endpoints.

use crate::tracks::distance;
use ddl_goal::{GoalSet, HeadingFrame};
use proptest::prelude::*;

fn frame() -> HeadingFrame {
    HeadingFrame::new(&[[3.0, -1.0], [3.4, -0.7], [3.8, -0.4]]).unwrap()
}

fn mean_distance(set: &GoalSet, ends: &[[f64; 2]], weights: &[f64]) -> f64 {
    let total: f64 = weights.iter().sum();
    let nearest = |end: &[f64; 2]| {
        let end = frame().to_world(*end);
        distance(set.goals()[set.nearest(end)], end)
    };
    ends.iter().zip(weights).map(|(end, w)| nearest(end) * w / total).sum()
}

proptest! {
    #[test]
    fn weights_are_a_distribution_and_enough_goals_are_the_ends(
        ends in prop::collection::vec((prop::array::uniform2(-9.0..9.0_f64), 0.01..1.0_f64), 1..120),
    ) {
        let (ends, weights): (Vec<_>, Vec<_>) = ends.into_iter().unzip();
        let set = |clusters| GoalSet::from_endpoints(&frame(), &ends, &weights, clusters).unwrap();
        for clusters in [1, 5, 150] {
            let set = set(clusters);
            prop_assert_eq!(set.goals().len(), clusters);
            prop_assert!((set.weights().iter().sum::<f64>() - 1.0).abs() < 1e-9);
            prop_assert!(set.weights().is_sorted_by(|a, b| a >= b));
        }
        let off = mean_distance(&set(150), &ends, &weights);
        prop_assert!(off < 1e-9, "one goal per endpoint, but {} m away", off);
    }

    #[test]
    fn the_order_of_the_ends_and_the_scale_of_the_weights_do_not_matter(
        ends in prop::collection::vec((prop::array::uniform2(-9.0..9.0_f64), 0.01..1.0_f64), 30..60),
        scale in 0.1..50.0_f64,
    ) {
        let (points, weights): (Vec<_>, Vec<_>) = ends.iter().copied().unzip();
        let (reversed, scaled): (Vec<_>, Vec<_>) =
            ends.iter().rev().map(|&(end, weight)| (end, weight * scale)).unzip();
        let one = GoalSet::from_endpoints(&frame(), &points, &weights, 8).unwrap();
        let other = GoalSet::from_endpoints(&frame(), &reversed, &scaled, 8).unwrap();
        let mean = |set: &GoalSet| mean_distance(set, &points, &weights);
        prop_assert!((mean(&one) - mean(&other)).abs() < 1e-6);
    }
}

#[test]
fn ends_of_no_weight_do_not_count_and_few_ends_repeat() {
    let ends = [[4.0, 0.0], [100.0, 0.0], [5.0, 2.0]];
    let set = GoalSet::from_endpoints(&frame(), &ends, &[0.75, 0.0, 0.25], 4).unwrap();
    assert_eq!(set.weights(), [0.75, 0.25, 0.0, 0.0]);
    assert_eq!(set.goals()[0], frame().to_world([4.0, 0.0]));
    assert_eq!(set.goals()[1], frame().to_world([5.0, 2.0]));
    assert!(set.goals()[2..].iter().all(|goal| set.goals()[..2].contains(goal)));
}

#[test]
fn invalid_endpoints_are_reported() {
    let error_of = |ends: &[[f64; 2]], weights: &[f64], clusters| {
        GoalSet::from_endpoints(&frame(), ends, weights, clusters).unwrap_err().to_string()
    };
    let end = [[1.0, 1.0]];
    assert!(error_of(&[], &[], 3).contains("0 endpoints"));
    assert!(error_of(&end, &[0.5, 0.5], 3).contains("1 endpoints with 2 weights"));
    assert!(error_of(&end, &[1.0], 0).contains("0 goals"));
    assert!(error_of(&end, &[0.0], 3).contains("not all 0"));
    assert!(error_of(&[end[0], end[0]], &[-1.0, 2.0], 3).contains("not negative"));
    assert!(error_of(&end, &[f64::NAN], 3).contains("NaN"));
    assert!(error_of(&end, &[f64::INFINITY], 3).contains("inf"));
    assert!(error_of(&[[f64::NAN, 0.0]], &[1.0], 3).contains("endpoint 0"));
    assert!(error_of(&[[1e300, 0.0]], &[1.0], 3).contains("endpoint 0"));
}
