//! Which hypothesis stands for all of a pedestrian: numbers worked out by hand, and what must hold of any.

use ddl_data::{HORIZON, Position};
use ddl_eval::{Forecast, Protocol, representative::medoid};
use proptest::{collection::vec, prelude::*};

use crate::generated::{forecast, position};

/// One pedestrian whose hypotheses walk straight and evenly from the origin to these ends.
fn to_ends(ends: &[Position], weights: &[f64]) -> Forecast {
    let positions = ends.iter().flat_map(|end| {
        let share = |t: usize| t as f64 / HORIZON as f64;
        (1..=HORIZON).map(move |t| end.map(|c| share(t) * c))
    });
    Forecast::new(1, ends.len(), positions.collect(), weights.to_vec(), None).unwrap()
}

/// `sum_j w_j mean_t |p_k(t) - p_j(t)|`, written down once more.
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

/// Straight walks are 6.5/12 of the distance of their ends apart on average. Weights 0.3, 0.25, 0.25, 0.2 at the ends 0, 4,
/// 5 and 7 m; in that order
/// 0.25 * 4 + 0.25 * 5 + 0.2 * 7 = 3.65; 0.3 * 4 + 0.25 * 1 + 0.2 * 3 = 2.05; 0.3 * 5 + 0.25 * 1 + 0.2 * 2 = 2.15;
/// 0.3 * 7 + 0.25 * 3 + 0.25 * 2 = 3.35.
#[test]
fn of_four_straight_walks() {
    let ends = [[0.0, 0.0], [4.0, 0.0], [5.0, 0.0], [7.0, 0.0]];
    let forecast = to_ends(&ends, &[0.3, 0.25, 0.25, 0.2]);
    for (k, by_hand) in [3.65, 2.05, 2.15, 3.35].into_iter().enumerate() {
        let found = expected_ade(&forecast, 0, k);
        assert!((found - by_hand * 6.5 / 12.0).abs() < 1e-12, "{k}: {found}");
    }
    assert_eq!(forecast.most_likely(0), 0);
    assert_eq!(forecast.representative(0), 1);
    let single = forecast.single();
    assert_eq!((single.hypotheses(), single.weight(0, 0)), (1, 1.0));
    assert_eq!(single.hypothesis(0, 0), forecast.hypothesis(0, 1));
}

/// The middle of a path counts, not its end alone: three walks end together, one of them by a detour of 5 m.
#[test]
fn paths_are_compared_and_not_ends() {
    let straight = |aside: f64| (1..=HORIZON).map(move |t| [t as f64, aside]);
    let detour = (1..=HORIZON).map(|t| [t as f64, if t == HORIZON { 0.1 } else { 5.0 }]);
    let positions = detour
        .chain(straight(0.0))
        .chain(straight(0.2))
        .chain(straight(0.1))
        .collect();
    let forecast = Forecast::new(1, 4, positions, vec![0.28, 0.27, 0.27, 0.18], None).unwrap();
    let weights = [0.28, 0.27, 0.27, 0.18];
    let ends = [0.1_f64, 0.0, 0.2, 0.1];
    assert_eq!(medoid(&weights, |k, j| (ends[k] - ends[j]).abs()), 0);
    assert_eq!(forecast.most_likely(0), 0);
    assert_eq!(forecast.representative(0), 2);
}

/// Without weights all count alike: of the ends 0, 1, 2, 3 and 100 m the median, of the corners of a square the first.
#[test]
fn without_weights_all_count_alike() {
    let row = [3.0, 0.0, 100.0, 2.0, 1.0].map(|x| [x, 0.0]);
    let forecast = to_ends(&row, &[0.2; 5]);
    assert_eq!(forecast.most_likely(0), 0);
    assert_eq!(forecast.representative(0), 3);
    let corners = [[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]];
    assert_eq!(to_ends(&corners, &[0.25; 4]).representative(0), 0);
}

/// Equal but for the last digits of a sum: the heaviest, of equally heavy ones the first.
#[test]
fn ties_go_to_the_heaviest_and_then_to_the_first() {
    let one_metre = |k: usize, j: usize| if k == j { 0.0 } else { 1.0 };
    assert_eq!(medoid(&[1.0 / 3.0; 3], one_metre), 0);
    // Eight places, the same from both ends: what is summed from one end differs in the last digits from the other end.
    let weights = [0.1, 0.2, 0.15, 0.05, 0.05, 0.15, 0.2, 0.1];
    let places = [-4.0, -3.0, -2.0, -1.0, 1.0, 2.0, 3.0, 4.0_f64];
    let apart = |k: usize, j: usize| (places[k] - places[j]).abs();
    assert_eq!(medoid(&weights, apart), 3);
    let reversed = |k: usize, j: usize| (places[7 - k] - places[7 - j]).abs();
    assert_eq!(medoid(&weights, reversed), 3);
    // Two in one place, where the second is the heavier.
    let places = [0.0, 0.0, 5.0_f64];
    let apart = |k: usize, j: usize| (places[k] - places[j]).abs();
    assert_eq!(medoid(&[0.3, 0.5, 0.2], apart), 1);
}

/// Distances beyond all numbers, with and without weight, and one hypothesis alone.
#[test]
fn the_extremes() {
    let far = [[1e308, 0.0], [-1e308, 0.0], [0.0, 0.0]];
    assert_eq!(to_ends(&far, &[0.5, 0.0, 0.5]).representative(0), 0);
    assert_eq!(to_ends(&far, &[0.1, 0.2, 0.7]).representative(0), 2);
    assert_eq!(to_ends(&far[..2], &[0.4, 0.6]).representative(0), 1);
    assert_eq!(to_ends(&far[..1], &[1.0]).representative(0), 0);
}

#[test]
#[should_panic(expected = "nothing has no medoid")]
fn nothing_has_none() {
    let _ = medoid(&[], |_, _| 0.0);
}

/// Under `single` the goal and the verdict of the same hypothesis are kept.
#[test]
fn goal_and_verdict_follow() {
    let ends = [[0.0, 0.0], [4.0, 0.0], [5.0, 0.0]];
    let paths = to_ends(&ends, &[0.4, 0.3, 0.3]);
    let positions = (0..3).flat_map(|k| paths.hypothesis(0, k).to_vec());
    let forecast = Forecast::new(
        1,
        3,
        positions.collect(),
        vec![0.4, 0.3, 0.3],
        Some(ends.to_vec()),
    )
    .unwrap()
    .with_certified(vec![false, true, false])
    .unwrap();
    let single = Protocol::Single.admit(vec![forecast], "three").unwrap();
    assert_eq!(single[0].goal(0, 0), Some([4.0, 0.0]));
    assert_eq!(single[0].certified(0, 0), Some(true));
}

/// Hypotheses of one pedestrian.
fn any_forecast() -> impl Strategy<Value = Forecast> {
    (1..21_usize).prop_flat_map(|k| forecast(1, k, false, position()))
}

/// Hypothesis `order[k]` becomes hypothesis `k`; `weight` and `place` say what becomes of its parts.
fn rebuilt(
    forecast: &Forecast,
    order: &[usize],
    weight: impl Fn(usize) -> f64,
    place: impl Fn(Position) -> Position,
) -> Forecast {
    let paths = order.iter().flat_map(|&k| forecast.hypothesis(0, k));
    let positions = paths.map(|p| place(*p)).collect();
    let weights = order.iter().map(|&k| weight(k)).collect();
    Forecast::new(1, order.len(), positions, weights, None).unwrap()
}

fn in_order(forecast: &Forecast) -> Vec<usize> {
    (0..forecast.hypotheses()).collect()
}

proptest! {
    /// No hypothesis has a smaller expected error, the heaviest least of all.
    #[test]
    fn nothing_is_better_under_its_own_weights(forecast in any_forecast()) {
        let representative = forecast.representative(0);
        let found = expected_ade(&forecast, 0, representative);
        for k in 0..forecast.hypotheses() {
            prop_assert!(found <= expected_ade(&forecast, 0, k) + 1e-8, "{representative}, {k}");
        }
    }

    #[test]
    fn the_order_of_hypotheses_changes_the_index_alone(
        (forecast, order) in any_forecast().prop_flat_map(|forecast| {
            let order = Just(in_order(&forecast)).prop_shuffle();
            (Just(forecast), order)
        })
    ) {
        let shuffled = rebuilt(&forecast, &order, |k| forecast.weight(0, k), |p| p);
        prop_assert_eq!(order[shuffled.representative(0)], forecast.representative(0));
    }

    /// Turned, mirrored, moved away and made larger.
    #[test]
    fn motions_of_the_plane_change_nothing(
        forecast in any_forecast(),
        (turn, mirror, away) in (0.0..std::f64::consts::TAU, any::<bool>(), -500.0..500.0_f64),
        scale in 0.5..2.0_f64,
    ) {
        let (sin, cos) = turn.sin_cos();
        let moved = rebuilt(&forecast, &in_order(&forecast), |k| forecast.weight(0, k), |[x, y]| {
            let y = if mirror { -y } else { y };
            [scale * (cos * x - sin * y) + away, scale * (sin * x + cos * y) - 2.0 * away]
        });
        prop_assert_eq!(moved.representative(0), forecast.representative(0));
    }

    #[test]
    fn with_all_the_weight_on_one_it_is_that_one(
        forecast in any_forecast(), which in any::<prop::sample::Index>()
    ) {
        let sure = which.index(forecast.hypotheses());
        let weight = |k| if k == sure { 1.0 } else { 0.0 };
        let certain = rebuilt(&forecast, &in_order(&forecast), weight, |p| p);
        prop_assert_eq!(certain.representative(0), sure);
        // More than half is enough: every other is farther from it than from itself.
        let rest = 0.45 / (forecast.hypotheses().max(2) - 1) as f64;
        if forecast.hypotheses() > 1 {
            let weight = |k| if k == sure { 0.55 } else { rest };
            let most = rebuilt(&forecast, &in_order(&forecast), weight, |p| p);
            prop_assert_eq!(most.representative(0), sure);
        }
    }

    /// Without weights a hypothesis that is there twice counts twice: as one of twice the weight.
    #[test]
    fn a_weight_is_a_number_of_times(forecast in any_forecast(), times in vec(1..4_usize, 20)) {
        let order: Vec<usize> = in_order(&forecast)
            .into_iter()
            .flat_map(|k| std::iter::repeat_n(k, times[k]))
            .collect();
        let all = order.len() as f64;
        let alike = rebuilt(&forecast, &order, |_| 1.0 / all, |p| p);
        let weighted = rebuilt(&forecast, &in_order(&forecast), |k| times[k] as f64 / all, |p| p);
        let (alike, weighted) = (order[alike.representative(0)], weighted.representative(0));
        // Of two hypotheses as often as each other either will do.
        let error = |k| {
            let sum = (0..forecast.hypotheses()).map(|j| {
                let pairs = forecast.hypothesis(0, k).iter().zip(forecast.hypothesis(0, j));
                let apart: f64 = pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
                times[j] as f64 * apart
            });
            sum.sum::<f64>() / all
        };
        prop_assert!((error(alike) - error(weighted)).abs() < 1e-6);
    }
}
