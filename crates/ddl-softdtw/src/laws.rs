//! Properties of soft-DTW for all sequences.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod extremes;
mod precision;

use crate::SoftDtw;
use crate::grid::cost;
use proptest::prelude::*;

type Sequence = Vec<[f64; 2]>;

/// Of up to `longest` steps with components of up to `size`.
fn sequence(size: f64, longest: usize) -> impl Strategy<Value = Sequence> {
    prop::collection::vec(prop::array::uniform2(-size..size), 1..=longest)
}

fn dtw(gamma: f64) -> SoftDtw {
    SoftDtw::new(gamma).expect("valid gamma")
}

/// The costs of all warping paths through the first steps of both sequences, by enumeration.
fn costs_of_paths(x: &[[f64; 2]], y: &[[f64; 2]], so_far: f64, costs: &mut Vec<f64>) {
    let ([a, ..], [b, ..]) = (x, y) else { return };
    let so_far = so_far + cost(a, b);
    if x.len() == 1 && y.len() == 1 {
        costs.push(so_far);
    }
    for (of_x, of_y) in [(1, 1), (1, 0), (0, 1)] {
        costs_of_paths(&x[of_x..], &y[of_y..], so_far, costs);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn it_is_symmetric_to_the_last_bit(
        x in sequence(3.0, 19), y in sequence(3.0, 19), gamma in 0.0..3.0_f64,
    ) {
        let dtw = dtw(gamma);
        prop_assert_eq!(dtw.value(&x, &y)?.to_bits(), dtw.value(&y, &x)?.to_bits());
        prop_assert_eq!(dtw.normalised(&x, &y)?.to_bits(), dtw.normalised(&y, &x)?.to_bits());
        prop_assert_eq!(dtw.normalised(&x, &x)?.to_bits(), 0.0_f64.to_bits());
    }

    #[test]
    fn it_is_the_sum_over_all_paths_and_hard_dtw_the_cheapest(
        x in sequence(2.0, 6), y in sequence(2.0, 6), gamma in 0.2..3.0_f64,
    ) {
        let mut costs = Vec::new();
        costs_of_paths(&x, &y, 0.0, &mut costs);
        let sum: f64 = costs.iter().map(|c| (-c / gamma).exp()).sum();
        let value = dtw(gamma).value(&x, &y)?;
        prop_assert!((value + gamma * sum.ln()).abs() < 1e-12, "{} {}", value, -gamma * sum.ln());
        let cheapest = costs.into_iter().fold(f64::INFINITY, f64::min);
        let hard = dtw(0.0).value(&x, &y)?;
        prop_assert!((hard - cheapest).abs() < 1e-13 * (1.0 + cheapest));
    }

    #[test]
    fn the_fast_recursion_is_the_log_domain_within_both_bounds(
        x in sequence(1.0, 39), y in sequence(1.0, 39),
        gamma in -5.0..4.0_f64, scale in -2.0..4.0_f64,
    ) {
        let scaled = |s: &Sequence| s.iter().map(|p| p.map(|v| v * 10.0_f64.powf(scale))).collect::<Vec<_>>();
        let (x, y, gamma) = (scaled(&x), scaled(&y), 10.0_f64.powf(gamma));
        let (fast, slow) = (dtw(gamma).value(&x, &y)?, dtw(gamma).grid(&x, &y).log_domain_value());
        let path = (x.len() + y.len()) as f64;
        let bound = (14.0 + 2.0 * path) * f64::EPSILON / 2.0 * (slow.abs() + gamma * path);
        prop_assert!((fast - slow).abs() <= bound, "{} {}", fast, slow);
    }

    #[test]
    fn the_normalised_gradient_is_the_slope_and_0_at_equality(
        x in sequence(3.0, 9), y in sequence(3.0, 9), gamma in 0.05..3.0_f64,
    ) {
        let dtw = dtw(gamma);
        let (value, gradient) = dtw.normalised_and_gradient(&x, &y)?;
        prop_assert_eq!(value.to_bits(), dtw.normalised(&x, &y)?.to_bits());
        let h = 1e-5;
        for (i, step) in gradient.iter().enumerate() {
            for (d, component) in step.iter().enumerate() {
                let moved = |by: f64| {
                    let mut x = x.clone();
                    x[i][d] += by;
                    dtw.normalised(&x, &y)
                };
                let slope = (moved(h)? - moved(-h)?) / (2.0 * h);
                prop_assert!((component - slope).abs() < 1e-5, "{} {}", component, slope);
            }
        }
        let (_, gradient) = dtw.normalised_and_gradient(&x, &x)?;
        prop_assert!(gradient.as_flattened().iter().all(|&g| g == 0.0));
    }
}

/// By hand: the cheapest path matches the last step of x with the last two of y, at the costs 0 and 4.
#[test]
fn hard_dtw_has_the_gradient_of_its_cheapest_path() {
    let (x, y) = ([[0.0], [0.0], [1.0]], [[0.0], [1.0], [3.0]]);
    let hard = dtw(0.0);
    assert_eq!(hard.value_and_gradient(&x, &y).unwrap(), (4.0, vec![[0.0], [0.0], [-4.0]]));
    assert_eq!(hard.value_and_gradient(&y, &x).unwrap(), (4.0, vec![[0.0], [0.0], [4.0]]));
}
