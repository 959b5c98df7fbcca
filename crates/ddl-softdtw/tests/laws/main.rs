//! Properties of soft-DTW for all sequences.
#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![expect(clippy::float_cmp, reason = "exact values are what is claimed")]

mod band;
mod extremes;

use ddl_softdtw::{Band, Cost, SoftDtw};
use proptest::prelude::*;

type Sequence = Vec<[f64; 2]>;

/// Of up to `longest` steps with components of up to `size`.
fn sequence(size: f64, longest: usize) -> impl Strategy<Value = Sequence> {
    prop::collection::vec(prop::array::uniform2(-size..size), 1..=longest)
}

fn cost() -> impl Strategy<Value = Cost> {
    prop_oneof![Just(Cost::SquaredEuclidean), Just(Cost::Euclidean)]
}

/// A band's radius below `end`, or no band.
fn radius(end: usize) -> impl Strategy<Value = Option<usize>> {
    prop_oneof![Just(None), (0..end).prop_map(Some)]
}

fn dtw(gamma: f64, cost: Cost) -> SoftDtw {
    SoftDtw::new(gamma, cost).expect("valid gamma")
}

fn banded(gamma: f64, cost: Cost, radius: Option<usize>) -> SoftDtw {
    let free = dtw(gamma, cost);
    radius.map_or(free, |radius| free.with_band(Band::new(radius)))
}

/// The costs of all warping paths from cell (i, j) to the last one that stay in the band (if there is one), by
/// enumeration.
fn costs_of_paths(
    (cost, radius): (Cost, Option<usize>),
    (x, y): (&[[f64; 2]], &[[f64; 2]]),
    (i, j): (usize, usize),
    so_far: f64,
    found: &mut Vec<f64>,
) {
    let (n, m) = (x.len(), y.len());
    if i == n || j == m {
        return;
    }
    let off = (i * (m - 1)).abs_diff(j * (n - 1)) as f64;
    if radius.is_some_and(|radius| off > (radius as f64).max(0.5) * (n.max(m) - 1) as f64) {
        return;
    }
    let so_far = so_far + cost.between(&x[i], &y[j]);
    if (i, j) == (n - 1, m - 1) {
        found.push(so_far);
    }
    for next in [(i + 1, j + 1), (i + 1, j), (i, j + 1)] {
        costs_of_paths((cost, radius), (x, y), next, so_far, found);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn it_is_symmetric_to_the_last_bit(
        x in sequence(3.0, 19), y in sequence(3.0, 19),
        radius in radius(20), gamma in 0.0..3.0_f64, cost in cost(),
    ) {
        let dtw = banded(gamma, cost, radius);
        prop_assert_eq!(dtw.value(&x, &y)?.to_bits(), dtw.value(&y, &x)?.to_bits());
        prop_assert_eq!(dtw.normalised(&x, &y)?.to_bits(), dtw.normalised(&y, &x)?.to_bits());
        prop_assert_eq!(dtw.normalised(&x, &x)?.to_bits(), 0.0_f64.to_bits());
    }

    #[test]
    fn it_is_the_sum_over_all_paths_in_the_band_and_hard_dtw_the_cheapest(
        x in sequence(2.0, 6), y in sequence(2.0, 6),
        radius in radius(6), gamma in 0.2..3.0_f64, cost in cost(),
    ) {
        let mut costs = Vec::new();
        costs_of_paths((cost, radius), (&x, &y), (0, 0), 0.0, &mut costs);
        prop_assert!(!costs.is_empty(), "no band is too narrow for a path");
        let sum: f64 = costs.iter().map(|c| (-c / gamma).exp()).sum();
        let value = banded(gamma, cost, radius).value(&x, &y)?;
        prop_assert!((value + gamma * sum.ln()).abs() < 1e-12, "{} {}", value, -gamma * sum.ln());
        let cheapest = costs.into_iter().fold(f64::INFINITY, f64::min);
        let hard = banded(0.0, cost, radius).value(&x, &y)?;
        prop_assert!((hard - cheapest).abs() < 1e-13 * (1.0 + cheapest));
    }

    #[test]
    fn the_fast_recursion_is_the_log_domain_within_both_bounds(
        x in sequence(1.0, 39), y in sequence(1.0, 39),
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
    fn the_gradients_are_the_slopes(
        x in sequence(3.0, 9), y in sequence(3.0, 9), radius in radius(6), gamma in 0.05..3.0_f64, cost in cost(),
    ) {
        let dtw = banded(gamma, cost, radius);
        // If two steps nearly coincide, finite differences would cross the kink of the Euclidean cost.
        let kink = x.iter().any(|a| y.iter().any(|b| Cost::Euclidean.between(a, b) < 1e-2));
        prop_assume!(cost == Cost::SquaredEuclidean || !kink);
        let (_, of_x, of_y) = dtw.value_and_gradients(&x, &y)?;
        let h = 1e-5;
        for (moves_x, gradient) in [(true, of_x), (false, of_y)] {
            for (i, step) in gradient.iter().enumerate() {
                for (d, component) in step.iter().enumerate() {
                    let at = |by: f64| {
                        let (mut x, mut y) = (x.clone(), y.clone());
                        if moves_x { x[i][d] += by } else { y[i][d] += by }
                        dtw.value(&x, &y)
                    };
                    let slope = (at(h)? - at(-h)?) / (2.0 * h);
                    prop_assert!((component - slope).abs() < 1e-5, "{} {}", component, slope);
                }
            }
        }
    }

    #[test]
    fn the_normalised_gradient_is_the_slope_and_0_at_equality(
        x in sequence(3.0, 9), y in sequence(3.0, 9), gamma in 0.1..3.0_f64,
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
}

/// By hand: the cheapest path matches the last step of x with the last two of y, at the costs 0 and 4.
#[test]
fn hard_dtw_has_the_gradient_of_its_cheapest_path() {
    let (x, y) = ([[0.0], [0.0], [1.0]], [[0.0], [1.0], [3.0]]);
    let (value, of_x, of_y) = dtw(0.0, Cost::SquaredEuclidean).value_and_gradients(&x, &y).unwrap();
    assert_eq!((value, of_x), (4.0, vec![[0.0], [0.0], [-4.0]]));
    assert_eq!(of_y, [[0.0], [0.0], [4.0]]);
}
