//! Values computed elsewhere in float64: 90 cases over five smoothings, both costs and several dimensions.
#![expect(
    clippy::unwrap_used,
    reason = "a test may fail this way, its helpers too"
)]

use ddl_softdtw::{Cost, SoftDtw};
use serde::Deserialize;

#[derive(Deserialize)]
struct Reference {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    x: Vec<Vec<f64>>,
    y: Vec<Vec<f64>>,
    gamma: f64,
    cost: String,
    value: f64,
    normalised: f64,
    grad_x_fd: Option<Vec<Vec<f64>>>,
}

/// A sequence of the fixture with the dimension as a constant.
fn fixed<const D: usize>(steps: &[Vec<f64>]) -> Vec<[f64; D]> {
    steps
        .iter()
        .map(|s| s.as_slice().try_into().expect("one dimension a case"))
        .collect()
}

/// Compares one case; the number of gradient components compared.
fn compare<const D: usize>(dtw: SoftDtw, case: &Case, number: usize) -> usize {
    let (x, y) = (fixed::<D>(&case.x), fixed::<D>(&case.y));
    let value = dtw.value(&x, &y).unwrap();
    assert!(
        (value - case.value).abs() < 1e-9,
        "case {number}: {value} {}",
        case.value
    );
    let normalised = dtw.normalised(&x, &y).unwrap();
    let error = (normalised - case.normalised).abs();
    assert!(
        error < 1e-9,
        "case {number}: {normalised} {}",
        case.normalised
    );

    let (with_gradient, gradient) = dtw.value_and_gradient(&x, &y).unwrap();
    assert_eq!(with_gradient.to_bits(), value.to_bits());
    assert_eq!(gradient.len(), x.len());
    let Some(expected) = &case.grad_x_fd else {
        return 0;
    };
    for (found, expected) in gradient
        .as_flattened()
        .iter()
        .zip(expected.iter().flatten())
    {
        assert!(
            (found - expected).abs() < 1e-5,
            "case {number}: {found} {expected}"
        );
    }
    gradient.as_flattened().len()
}

#[test]
fn values_normalised_values_and_gradients() {
    let reference: Reference =
        serde_json::from_str(include_str!("reference/soft_dtw.json")).expect("the fixture is JSON");
    assert_eq!(reference.cases.len(), 90);
    let mut components = 0;
    for (number, case) in reference.cases.iter().enumerate() {
        let cost = match case.cost.as_str() {
            "squared_euclidean" => Cost::SquaredEuclidean,
            "euclidean" => Cost::Euclidean,
            other => panic!("case {number}: unknown cost {other}"),
        };
        let dtw = SoftDtw::new(case.gamma, cost).expect("valid gamma");
        components += match case.x[0].len() {
            1 => compare::<1>(dtw, case, number),
            2 => compare::<2>(dtw, case, number),
            3 => compare::<3>(dtw, case, number),
            4 => compare::<4>(dtw, case, number),
            other => panic!("case {number}: {other} dimensions"),
        };
    }
    assert!(
        components > 100,
        "only {components} components of gradients compared"
    );
}
