//! The stated error bounds, against values of 60 decimal digits from `tests/reference/high_precision.py`.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use crate::SoftDtw;
use crate::grid::cost;
use serde::Deserialize;

const UNIT: f64 = f64::EPSILON / 2.0;

#[derive(Deserialize)]
struct ExactValue {
    cases: Vec<PrecisionCase>,
}

#[derive(Deserialize)]
struct PrecisionCase {
    n: usize,
    m: usize,
    dimension: usize,
    spread: f64,
    offset: f64,
    gamma: f64,
    value: f64,
    normalised: Option<f64>,
    /// The gradient of all steps of x, or of its first two and last two.
    gradient: Vec<Vec<f64>>,
}

/// The sequences of the script: multiples of 1/64.
fn sequence<const D: usize>(steps: usize, seed: usize, spread: f64, offset: f64) -> Vec<[f64; D]> {
    let component = |i: usize, k: usize| {
        let residue = (37 * i * i + 11 * seed * i + 29 * k + 13 * seed) % 101;
        offset + (residue as f64 - 50.0) * spread / 64.0
    };
    (0..steps).map(|i| std::array::from_fn(|k| component(i, k))).collect()
}

/// The larger of the errors of value and normalised value, in units of the stated bound.
fn compare<const D: usize>(number: usize, case: &PrecisionCase) -> f64 {
    let dtw = SoftDtw::new(case.gamma).unwrap();
    let x = sequence::<D>(case.n, 1, case.spread, case.offset);
    let y = sequence::<D>(case.m, 2, case.spread, 0.0);
    let (n, m) = (case.n as f64, case.m as f64);
    let bound = |value: f64| (D as f64 + 12.0) * UNIT * (value.abs() + case.gamma * (n + m));

    let (value, gradient) = dtw.value_and_gradient(&x, &y).unwrap();
    assert_eq!(value.to_bits(), dtw.value(&x, &y).unwrap().to_bits());
    let mut ratio = (value - case.value).abs() / bound(case.value);
    if let Some(expected) = case.normalised {
        let self_values = [dtw.value(&x, &x).unwrap(), dtw.value(&y, &y).unwrap()];
        let slack = bound(value) + 0.5 * self_values.iter().map(|v| bound(*v)).sum::<f64>();
        let error = (dtw.normalised(&x, &y).unwrap() - expected).abs();
        ratio = ratio.max(error / slack);
    }
    assert!(ratio <= 1.0, "case {number}: {value} {}", case.value);

    // The reference has its own rounding errors, which grow with the length of a path.
    let slow = dtw.grid(&x, &y).log_domain_value();
    let slack = (1.0 + n + m) * bound(case.value);
    assert!((slow - case.value).abs() <= slack, "case {number}: {slow}");

    // |Σ_j E(i, j) slope(i, j)| errs by at most 3 b / γ times its absolute terms, none of which is larger than this.
    let costs = x.iter().flat_map(|a| y.iter().map(|b| cost(a, b)));
    let slope = 2.0 * costs.fold(0.0, f64::max).sqrt();
    let slack = (3.0 * bound(value) / case.gamma + 4.0 * UNIT * m) * slope * m;
    let shown = (0..case.n).filter(|i| case.n <= 10 || *i < 2 || *i + 2 >= case.n);
    assert_eq!(shown.clone().count(), case.gradient.len());
    for (i, expected) in shown.zip(&case.gradient) {
        for (component, expected) in gradient[i].iter().zip(expected) {
            let error = (component - expected).abs();
            assert!(error <= slack, "case {number}, step {i}: {component} {expected}");
        }
    }
    ratio
}

#[test]
fn values_and_gradients_keep_the_stated_bounds() {
    let text = include_str!("../../tests/reference/high_precision.json");
    let reference: ExactValue = serde_json::from_str(text).unwrap();
    assert_eq!(reference.cases.len(), 18);
    let mut worst = 0.0_f64;
    for (number, case) in reference.cases.iter().enumerate() {
        let ratio = match case.dimension {
            1 => compare::<1>(number, case),
            2 => compare::<2>(number, case),
            3 => compare::<3>(number, case),
            other => panic!("case {number}: {other} dimensions"),
        };
        worst = worst.max(ratio);
    }
    assert!(worst > 1e-3, "a bound a thousand times too wide: {worst}");
}
