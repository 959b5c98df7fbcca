//! The representative hypothesis: examples computed by hand, and properties.

use ddl_core::{Forecast, HORIZON, Position, average_displacement, medoid};
use proptest::collection::vec;
use proptest::prelude::*;

/// One pedestrian whose hypotheses go straight from the origin to these ends at constant speed.
fn to_ends(ends: &[Position], weights: &[f64]) -> Forecast {
    let positions = ends.iter().flat_map(|end| {
        let share = |t: usize| t as f64 / HORIZON as f64;
        (1..=HORIZON).map(move |t| end.map(|c| share(t) * c))
    });
    Forecast::new(1, ends.len(), positions.collect(), weights.to_vec(), None).unwrap()
}

/// `sum_j w_j mean_t |p_k(t) - p_j(t)|`, written separately.
fn expected_ade(forecast: &Forecast, i: usize, k: usize) -> f64 {
    let mut sum = 0.0;
    for j in 0..forecast.hypotheses() {
        let (mut apart, path) = (0.0, forecast.hypothesis(i, k));
        for (a, b) in path.iter().zip(forecast.hypothesis(i, j)) {
            apart += ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt();
        }
        sum += forecast.weight(i, j) * apart / path.len() as f64;
    }
    sum
}

/// Straight walks are 6.5/12 of the distance of their ends apart on average. Weights 0.3, 0.25, 0.25, 0.2 at the ends
/// 0, 4, 5 and 7 m; in that order 0.25 * 4 + 0.25 * 5 + 0.2 * 7 = 3.65; 0.3 * 4 + 0.25 * 1 + 0.2 * 3 = 2.05; 0.3 * 5 +
/// 0.25 * 1 + 0.2 * 2 = 2.15; 0.3 * 7 + 0.25 * 3 + 0.25 * 2 = 3.35.
#[test]
fn of_four_straight_walks() {
    let ends = [[0.0, 0.0], [4.0, 0.0], [5.0, 0.0], [7.0, 0.0]];
    let forecast = to_ends(&ends, &[0.3, 0.25, 0.25, 0.2]);
    for (k, by_hand) in [3.65, 2.05, 2.15, 3.35].into_iter().enumerate() {
        let error = expected_ade(&forecast, 0, k);
        assert!((error - by_hand * 6.5 / 12.0).abs() < 1e-12, "{k}: {error}");
    }
    assert_eq!(forecast.most_likely(0), 0);
    assert_eq!(forecast.representative(0), 1);
    let single = forecast.single();
    assert_eq!((single.hypotheses(), single.weight(0, 0)), (1, 1.0));
    assert_eq!(single.hypothesis(0, 0), forecast.hypothesis(0, 1));
    // 5 m and 2.5 m.
    let apart = average_displacement(&[[3.0, 4.0], [1.0, 0.0]], &[[0.0, 0.0], [-0.5, 2.0]]);
    assert!((apart - 3.75).abs() < 1e-12);
}

#[test]
fn ties_go_to_the_heaviest_and_then_to_the_first() {
    let one_metre = |k: usize, j: usize| if k == j { 0.0 } else { 1.0 };
    assert_eq!(medoid(&[1.0 / 3.0; 3], one_metre), 0);
    // Eight symmetric positions: sums from the two ends differ in their last digits.
    let weights = [0.1, 0.2, 0.15, 0.05, 0.05, 0.15, 0.2, 0.1];
    let places = [-4.0, -3.0, -2.0, -1.0, 1.0, 2.0, 3.0, 4.0_f64];
    let apart = |k: usize, j: usize| (places[k] - places[j]).abs();
    assert_eq!(medoid(&weights, apart), 3);
    let reversed = |k: usize, j: usize| (places[7 - k] - places[7 - j]).abs();
    assert_eq!(medoid(&weights, reversed), 3);
    // Both sides of 1.2 and 2.6 weigh a half; by rounding the sum of 1.2 is less.
    let places = [0.3, 0.6, 1.1, 1.2, 2.6_f64];
    let apart = |k: usize, j: usize| (places[k] - places[j]).abs();
    assert_eq!(medoid(&[0.1, 0.2, 0.1, 0.1, 0.5], apart), 4);
    // Two at one position, of which the second has the greater weight.
    let places = [0.0, 0.0, 5.0_f64];
    let apart = |k: usize, j: usize| (places[k] - places[j]).abs();
    assert_eq!(medoid(&[0.3, 0.5, 0.2], apart), 1);
}

#[test]
fn the_extremes() {
    let far = [[1e308, 0.0], [-1e308, 0.0], [0.0, 0.0]];
    assert_eq!(to_ends(&far, &[0.5, 0.0, 0.5]).representative(0), 0);
    assert_eq!(to_ends(&far, &[0.1, 0.2, 0.7]).representative(0), 2);
    assert_eq!(to_ends(&far[..2], &[0.4, 0.6]).representative(0), 1);
    assert_eq!(to_ends(&far[..1], &[1.0]).representative(0), 0);
}

/// Forecasts of one pedestrian with 1 to 20 hypotheses.
fn forecasts() -> impl Strategy<Value = Forecast> {
    let hypothesis = (vec([-20.0..20.0, -20.0..20.0_f64], HORIZON), 0.01..1.0_f64);
    vec(hypothesis, 1..21_usize).prop_map(|hypotheses| {
        let sum: f64 = hypotheses.iter().map(|(_, weight)| weight).sum();
        let weights = hypotheses.iter().map(|(_, weight)| weight / sum).collect();
        let positions = hypotheses.iter().flat_map(|(path, _)| path.clone()).collect();
        Forecast::new(1, hypotheses.len(), positions, weights, None).unwrap()
    })
}

proptest! {
    #[test]
    fn nothing_is_better_under_its_own_weights(forecast in forecasts()) {
        let representative = forecast.representative(0);
        let error = expected_ade(&forecast, 0, representative);
        for k in 0..forecast.hypotheses() {
            prop_assert!(error <= expected_ade(&forecast, 0, k) + 1e-8, "{representative}, {k}");
        }
    }
}
