//! What soft-DTW must satisfy whatever the sequences.
#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![expect(clippy::float_cmp, reason = "exact values are what is claimed")]

use ddl_softdtw::{Band, Cost, SoftDtw, SoftDtwError};
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

    #[test]
    fn no_finite_input_gives_nan(
        x in prop::collection::vec(prop::array::uniform2(prop::num::f64::NORMAL | prop::num::f64::ZERO | prop::num::f64::SUBNORMAL), 1..6),
        y in prop::collection::vec(prop::array::uniform2(prop::num::f64::NORMAL | prop::num::f64::ZERO), 1..6),
        gamma in prop_oneof![Just(0.0), Just(f64::MIN_POSITIVE / 4.0), Just(1e-3), Just(1.0), Just(1e300), Just(f64::MAX)],
        cost in cost(), radius in prop::option::of(0..4_usize), tiny in any::<bool>(),
    ) {
        let free = dtw(gamma, cost);
        let dtw = radius.map_or(free, |radius| free.with_band(Band::new(radius)));
        // Components of every size, or all of them small enough for their squares.
        let shrunk = |s: &Sequence| s.iter().map(|p| p.map(|v| if tiny { v % 1e150 } else { v })).collect::<Vec<_>>();
        let (x, y) = (shrunk(&x), shrunk(&y));
        for result in [dtw.value(&x, &y), dtw.normalised(&x, &y), dtw.value_and_gradient(&x, &y).map(|r| r.0)] {
            match result {
                Ok(value) => prop_assert!(value.is_finite()),
                Err(error) => prop_assert!(!tiny && error == SoftDtwError::Overflow || gamma > 1e299, "{}", error),
            }
        }
        let narrow = |s: &Sequence| s.iter().map(|p| p.map(|v| (v as f32).clamp(f32::MIN, f32::MAX))).collect::<Vec<_>>();
        match dtw.value_and_gradient(&narrow(&x), &narrow(&y)) {
            Ok((value, gradient)) => {
                prop_assert!(value.is_finite() && gradient.as_flattened().iter().all(|g| g.is_finite()));
            }
            Err(error) => prop_assert_eq!(error, SoftDtwError::Overflow),
        }
    }
}

#[test]
fn costs_of_a_million_at_a_thousandth_are_finite() {
    let x: Vec<[f64; 2]> = (0..8).map(|i| [1000.0 + f64::from(i), 0.0]).collect();
    let y: Vec<[f64; 2]> = (0..8).map(|i| [0.0, f64::from(i)]).collect();
    let sharp = dtw(1e-3, Cost::SquaredEuclidean);
    let hard = dtw(0.0, Cost::SquaredEuclidean).value(&x, &y).unwrap();
    assert!(hard > 8e6);
    assert!((sharp.value(&x, &y).unwrap() - hard).abs() < 0.02);
    let (_, gradient) = sharp.value_and_gradient(&x, &y).unwrap();
    assert!(gradient.as_flattened().iter().all(|g| g.is_finite()));
    assert!(
        gradient.iter().all(|g| g[0] > 1999.0),
        "every step pulls towards y"
    );
}

#[test]
fn long_sequences_and_other_dimensions() {
    let wave = |phase: f64| -> Vec<[f64; 3]> {
        (0..500)
            .map(|i| 0.1 * f64::from(i) + phase)
            .map(|t| [t.sin(), t.cos(), 0.01 * t])
            .collect()
    };
    let dtw = dtw(0.1, Cost::SquaredEuclidean);
    let near = dtw.normalised(&wave(0.0), &wave(0.1)).unwrap();
    let far = dtw.normalised(&wave(0.0), &wave(2.0)).unwrap();
    assert!(near.is_finite() && near < far);
}

#[test]
fn the_number_of_paths_may_leave_the_range_of_f64() {
    // All costs 0: minus the logarithm of a Delannoy number, here about 2^3400.
    let smooth = dtw(1.0, Cost::SquaredEuclidean);
    let zeros = |steps| vec![[0.0_f64]; steps];
    let value = smooth.value(&zeros(1500), &zeros(1200)).unwrap();
    let oracle = smooth.log_domain_value(&zeros(1500), &zeros(1200)).unwrap();
    assert!(value < -2300.0);
    assert!((value - oracle).abs() < 1e-9, "{value} {oracle}");
    // And half a power of two lost in each of 2 · 1400 cells does not either.
    let half = vec![[std::f64::consts::LN_2.sqrt() * 0.7]; 1400];
    let value = smooth.value(&half, &zeros(1400)).unwrap();
    let oracle = smooth.log_domain_value(&half, &zeros(1400)).unwrap();
    assert!((value - oracle).abs() < 1e-9, "{value} {oracle}");
    let (_, gradient) = smooth.value_and_gradient(&half, &zeros(1400)).unwrap();
    let (_, oracle) = smooth.log_domain_gradient(&half, &zeros(1400)).unwrap();
    for (a, b) in gradient.iter().zip(&oracle) {
        assert!((a[0] - b[0]).abs() < 1e-8, "{} {}", a[0], b[0]);
    }
}

#[test]
fn bad_input_is_refused_by_name() {
    for gamma in [-1.0, f64::NAN, f64::INFINITY] {
        let error = SoftDtw::new(gamma, Cost::SquaredEuclidean).unwrap_err();
        assert!(matches!(error, SoftDtwError::InvalidGamma { .. }));
    }
    let dtw = dtw(1.0, Cost::SquaredEuclidean);
    let empty: &[[f64; 1]] = &[];
    let message = |result: Result<f64, SoftDtwError>| result.unwrap_err().to_string();
    let expected = "sequence y is empty: soft-DTW needs at least one step";
    assert_eq!(message(dtw.value(&[[0.0]], empty)), expected);
    assert!(dtw.value(empty, &[[0.0]]).is_err());
    let expected = "sequence x, step 1, component 0 is NaN: must be finite";
    assert_eq!(message(dtw.value(&[[0.0], [f64::NAN]], &[[0.0]])), expected);
    assert!(
        dtw.value_and_gradient(&[[0.0]], &[[f64::INFINITY]])
            .is_err()
    );
    assert_eq!(
        dtw.value(&[[1e200]], &[[-1e200]]),
        Err(SoftDtwError::Overflow)
    );
    // In f64 this is a number, in f32 it is not.
    assert_eq!(
        dtw.value(&[[3e38_f32]], &[[0.0]]),
        Err(SoftDtwError::Overflow)
    );
    let straight = SoftDtw::new(1.0, Cost::Euclidean).unwrap();
    assert_eq!(straight.value(&[[3e38_f32]], &[[0.0]]), Ok(3e38));
}
