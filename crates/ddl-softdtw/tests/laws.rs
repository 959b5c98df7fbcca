//! What soft-DTW must satisfy whatever the sequences.
#![expect(clippy::float_cmp, reason = "exact values are what is claimed")]

use ddl_softdtw::{Cost, SoftDtw};
use proptest::prelude::*;

type Sequence = Vec<[f64; 2]>;

fn sequence() -> impl Strategy<Value = Sequence> {
    prop::collection::vec(prop::array::uniform2(-3.0..3.0_f64), 1..10)
}

fn cost() -> impl Strategy<Value = Cost> {
    prop_oneof![Just(Cost::SquaredEuclidean), Just(Cost::Euclidean)]
}

fn dtw(gamma: f64, cost: Cost) -> SoftDtw {
    SoftDtw::new(gamma, cost).expect("valid gamma")
}

/// What is left of both sequences after each of the steps a warping path may take.
fn ways<'a>(
    x: &'a [[f64; 2]],
    y: &'a [[f64; 2]],
) -> impl Iterator<Item = (&'a [[f64; 2]], &'a [[f64; 2]])> {
    let ways = [(1, 1), (1, 0), (0, 1)].map(|(dx, dy)| (&x[dx..], &y[dy..]));
    ways.into_iter()
        .filter(|(x, y)| !x.is_empty() && !y.is_empty())
}

/// Hard DTW by its definition: the least cost over all warping paths, each walked to its end.
fn cheapest_path(cost: Cost, x: &[[f64; 2]], y: &[[f64; 2]]) -> f64 {
    let here = cost.between(&x[0], &y[0]);
    let onward = ways(x, y).map(|(x, y)| cheapest_path(cost, x, y));
    here + onward.reduce(f64::min).unwrap_or(0.0)
}

/// Soft-DTW by its definition: Σ exp(−cost/γ) over all warping paths.
fn sum_over_paths(gamma: f64, cost: Cost, x: &[[f64; 2]], y: &[[f64; 2]]) -> f64 {
    let here = (-cost.between(&x[0], &y[0]) / gamma).exp();
    let onward = ways(x, y).map(|(x, y)| sum_over_paths(gamma, cost, x, y));
    here * onward.reduce(|a, b| a + b).unwrap_or(1.0)
}

fn log_paths(n: usize, m: usize) -> f64 {
    let zeros = |steps| vec![[0.0, 0.0]; steps];
    sum_over_paths(1.0, Cost::SquaredEuclidean, &zeros(n), &zeros(m)).ln()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn it_is_symmetric_to_the_last_bit(
        x in sequence(), y in sequence(), gamma in 0.0..3.0_f64, cost in cost(),
    ) {
        let dtw = dtw(gamma, cost);
        prop_assert_eq!(dtw.value(&x, &y)?.to_bits(), dtw.value(&y, &x)?.to_bits());
        prop_assert_eq!(dtw.normalised(&x, &y)?.to_bits(), dtw.normalised(&y, &x)?.to_bits());
        prop_assert_eq!(dtw.normalised(&x, &x)?, 0.0);
    }

    #[test]
    fn hard_dtw_is_the_cheapest_path(
        x in prop::collection::vec(prop::array::uniform2(-3.0..3.0_f64), 1..6),
        y in prop::collection::vec(prop::array::uniform2(-3.0..3.0_f64), 1..6),
        cost in cost(),
    ) {
        let value = dtw(0.0, cost).value(&x, &y)?;
        prop_assert!((value - cheapest_path(cost, &x, &y)).abs() < 1e-12);
    }

    #[test]
    fn soft_dtw_sums_over_all_paths(
        x in prop::collection::vec(prop::array::uniform2(-2.0..2.0_f64), 1..6),
        y in prop::collection::vec(prop::array::uniform2(-2.0..2.0_f64), 1..6),
        gamma in 0.3..3.0_f64, cost in cost(),
    ) {
        let value = dtw(gamma, cost).value(&x, &y)?;
        let expected = -gamma * sum_over_paths(gamma, cost, &x, &y).ln();
        prop_assert!((value - expected).abs() < 1e-10, "{} {}", value, expected);
    }

    #[test]
    fn it_lies_below_hard_dtw_by_at_most_gamma_ln_paths(
        x in prop::collection::vec(prop::array::uniform2(-3.0..3.0_f64), 1..7),
        y in prop::collection::vec(prop::array::uniform2(-3.0..3.0_f64), 1..7),
        gamma in 1e-6..5.0_f64, cost in cost(),
    ) {
        // The gap closes with gamma: this is the limit gamma -> 0 as well.
        let hard = dtw(0.0, cost).value(&x, &y)?;
        let soft = dtw(gamma, cost).value(&x, &y)?;
        prop_assert!(soft <= hard + 1e-12 * hard);
        prop_assert!(soft >= hard - gamma * log_paths(x.len(), y.len()) - 1e-9);
    }

    #[test]
    fn more_smoothing_lowers_it(
        x in sequence(), y in sequence(), gamma in 0.0..2.0_f64, more in 1e-3..2.0_f64, cost in cost(),
    ) {
        let less_smooth = dtw(gamma, cost).value(&x, &y)?;
        let smoother = dtw(gamma + more, cost).value(&x, &y)?;
        prop_assert!(smoother <= less_smooth + 1e-12 * less_smooth.abs());
    }

    #[test]
    fn moving_both_sequences_changes_nothing(
        x in sequence(), y in sequence(), gamma in 0.0..3.0_f64, cost in cost(),
        by in prop::array::uniform2(-100.0..100.0_f64),
    ) {
        let moved = |s: &Sequence| s.iter().map(|p| [p[0] + by[0], p[1] + by[1]]).collect::<Vec<_>>();
        let dtw = dtw(gamma, cost);
        let difference = dtw.value(&moved(&x), &moved(&y))? - dtw.value(&x, &y)?;
        prop_assert!(difference.abs() < 1e-9, "{}", difference);
    }

    #[test]
    fn units_scale_out(x in sequence(), y in sequence(), gamma in 0.0..3.0_f64, scale in 0.1..10.0_f64) {
        let scaled = |s: &Sequence| s.iter().map(|p| p.map(|v| v * scale)).collect::<Vec<_>>();
        let one = dtw(gamma, Cost::SquaredEuclidean).value(&x, &y)? * scale * scale;
        let other = dtw(gamma * scale * scale, Cost::SquaredEuclidean)
            .value(&scaled(&x), &scaled(&y))?;
        prop_assert!((one - other).abs() < 1e-9 * (1.0 + one.abs()));
    }

    #[test]
    fn the_fast_recursion_is_the_log_domain_within_both_bounds(
        x in prop::collection::vec(prop::array::uniform2(-1.0..1.0_f64), 1..40),
        y in prop::collection::vec(prop::array::uniform2(-1.0..1.0_f64), 1..40),
        gamma in -5.0..4.0_f64, scale in -2.0..4.0_f64, cost in cost(),
    ) {
        let scaled = |s: &Sequence| s.iter().map(|p| p.map(|v| v * 10.0_f64.powf(scale))).collect::<Vec<_>>();
        let (x, y, gamma) = (scaled(&x), scaled(&y), 10.0_f64.powf(gamma));
        let (fast, slow) = (dtw(gamma, cost).value(&x, &y)?, dtw(gamma, cost).log_domain_value(&x, &y)?);
        let path = (x.len() + y.len()) as f64;
        let bound = (14.0 + 2.0 * path) * f64::EPSILON / 2.0 * (slow.abs() + gamma * path);
        prop_assert!((fast - slow).abs() <= bound, "{} {}", fast, slow);
    }

    #[test]
    fn f32_is_f64_rounded_once(
        x in prop::collection::vec(prop::array::uniform2(-3.0..3.0_f32), 1..12),
        y in prop::collection::vec(prop::array::uniform2(-3.0..3.0_f32), 1..12),
        gamma in 0.0..3.0_f64, cost in cost(),
    ) {
        let wide = |s: &[[f32; 2]]| s.iter().map(|p| p.map(f64::from)).collect::<Vec<_>>();
        let dtw = dtw(gamma, cost);
        prop_assert_eq!(dtw.value(&x, &y)?, dtw.value(&wide(&x), &wide(&y))? as f32);
        prop_assert_eq!(dtw.normalised(&x, &y)?, dtw.normalised(&wide(&x), &wide(&y))? as f32);
        let (_, narrow) = dtw.normalised_and_gradient(&x, &y)?;
        let (_, wide) = dtw.normalised_and_gradient(&wide(&x), &wide(&y))?;
        let rounded: Vec<_> = wide.iter().map(|p| p.map(|v| v as f32)).collect();
        prop_assert_eq!(narrow, rounded);
    }

    #[test]
    fn the_gradient_is_the_slope(x in sequence(), y in sequence(), gamma in 0.05..3.0_f64, cost in cost()) {
        let dtw = dtw(gamma, cost);
        // Where two steps nearly coincide the Euclidean cost has a kink that finite differences step over.
        let kink = x.iter().any(|a| y.iter().any(|b| Cost::Euclidean.between(a, b) < 1e-2));
        prop_assume!(cost == Cost::SquaredEuclidean || !kink);
        let (_, gradient) = dtw.value_and_gradient(&x, &y)?;
        let h = 1e-5;
        for i in 0..x.len() {
            for d in 0..2 {
                let at = |by: f64| {
                    let mut moved = x.clone();
                    moved[i][d] += by;
                    dtw.value(&moved, &y)
                };
                let slope = (at(h)? - at(-h)?) / (2.0 * h);
                prop_assert!((gradient[i][d] - slope).abs() < 1e-5, "{} {}", gradient[i][d], slope);
            }
        }
    }

    #[test]
    fn the_normalised_gradient_is_the_slope_and_0_at_equality(
        x in sequence(), y in sequence(), gamma in 0.1..3.0_f64,
    ) {
        let dtw = dtw(gamma, Cost::SquaredEuclidean);
        let (value, gradient) = dtw.normalised_and_gradient(&x, &y)?;
        prop_assert_eq!(value.to_bits(), dtw.normalised(&x, &y)?.to_bits());
        let h = 1e-5;
        for i in 0..x.len() {
            let at = |by: f64| {
                let mut moved = x.clone();
                moved[i][0] += by;
                dtw.normalised(&moved, &y)
            };
            let slope = (at(h)? - at(-h)?) / (2.0 * h);
            prop_assert!((gradient[i][0] - slope).abs() < 1e-5);
        }
        let (_, own) = dtw.normalised_and_gradient(&x, &x)?;
        prop_assert!(own.as_flattened().iter().all(|&g| g == 0.0));
    }

    #[test]
    fn the_gradients_of_a_translation_invariant_value_sum_to_0(
        x in sequence(), y in sequence(), gamma in 0.0..3.0_f64, cost in cost(),
    ) {
        let dtw = dtw(gamma, cost);
        let (value, of_x, of_y) = dtw.value_and_gradients(&x, &y)?;
        prop_assert_eq!((value, of_x.clone()), dtw.value_and_gradient(&x, &y)?);
        for d in 0..2 {
            let total: f64 = of_x.iter().chain(&of_y).map(|g| g[d]).sum();
            prop_assert!(total.abs() < 1e-9, "{}", total);
        }
        // With several best paths (gamma = 0) the two orders may follow different ones; generic inputs have one.
        let (_, swapped) = dtw.value_and_gradient(&y, &x)?;
        for (a, b) in of_y.as_flattened().iter().zip(swapped.as_flattened()) {
            prop_assert!((a - b).abs() < 1e-9, "{} {}", a, b);
        }
    }
}
