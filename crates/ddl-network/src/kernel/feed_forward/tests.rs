//! Comparison with the formula in double precision, and properties of any layer.

mod exact;

use crate::kernel::Dropout;
use crate::kernel::feed_forward::FeedForward;
use ddl_simd::InstructionSet;
use exact::Case;
use proptest::prelude::*;

const UNIT: f64 = 1.0 / 16_777_216.0;

#[track_caller]
fn assert_near(name: &str, results: &[f32], exact: &[f64], bounds: &[f64]) {
    assert_eq!(results.len(), exact.len(), "{name}");
    for (i, result) in results.iter().enumerate() {
        let error = (f64::from(*result) - exact[i]).abs();
        assert!(
            error <= bounds[i],
            "{name}[{i}]: {result} for {}, {error:e} > {:e}",
            exact[i],
            bounds[i]
        );
    }
}

fn layers(case: &Case) -> Vec<FeedForward> {
    let sets = InstructionSet::available();
    assert!(sets.contains(&InstructionSet::Portable));
    let layer = |set| case.layer().with_instructions(set).unwrap();
    sets.into_iter().map(layer).collect()
}

fn check(case: &Case) {
    let exact = case.exact();
    let scaled = |steps: usize, [sizes, doubts]: [&[f64]; 2]| -> Vec<f64> {
        let bound = |(size, doubt): (&f64, &f64)| steps as f64 * UNIT * size + doubt + 1e-37;
        sizes.iter().zip(doubts).map(bound).collect()
    };
    let (width, hidden, rows) = (case.width, case.hidden, case.x.len() / case.width);
    for layer in layers(case) {
        let (y, gx, grads) = case.run(&layer);
        let name = |what: &str| format!("{:?}, {what}, {width} x {rows} x {hidden}", layer.dispatch);
        let none = vec![0.0; y.len()];
        let bounds = scaled(width + hidden + 8, [&exact.y.sizes, &none]);
        assert_near(&name("y"), &y, &exact.y.values, &bounds);
        let gradients = [gx, grads.w1, grads.b1, grads.w2, grads.b2];
        for (i, what) in ["gx", "W1", "b1", "W2", "b2"].into_iter().enumerate() {
            let steps = width + 16 + if i == 0 { hidden } else { rows };
            let exact = &exact.gradients[i];
            let bounds = scaled(steps, [&exact.sizes, &exact.doubts]);
            assert_near(&name(what), &gradients[i], &exact.values, &bounds);
        }
    }
}

#[test]
fn the_error_bounds_hold_at_the_edges() {
    for (width, hidden, rows, p) in [
        (32, 64, 0, 0.1),
        (16, 16, 1, 0.0),
        (32, 48, 7, 0.1),
        (64, 64, 8, 0.0),
        (32, 2048, 65, 0.1),
        (32, 64, 1301, 0.5),
        (33, 300, 531, 0.9),
    ] {
        let dropout = Some(Dropout { p, seed: 11 });
        check(&Case::new(width, hidden, rows, dropout));
    }
}

#[test]
fn what_is_not_a_number_stays_in_its_row() {
    let mut case = Case::new(32, 64, 12, None);
    case.x[5 * 32 + 3] = f32::NAN;
    for layer in layers(&case) {
        let (y, gx, grads) = case.run(&layer);
        for (r, row) in y.chunks(32).enumerate() {
            assert!(row.iter().all(|y| y.is_nan() == (r == 5)), "{:?}, {r}", layer.dispatch);
        }
        // As in libtorch, the derivative of ReLU at NaN is 1.
        assert!(gx.iter().all(|gx| gx.is_finite()));
        assert!(grads.w2.iter().all(|g| g.is_nan()));
    }
}

fn dropouts() -> impl Strategy<Value = Option<Dropout>> {
    prop_oneof![
        Just(None),
        (0.0..0.95, any::<u64>()).prop_map(|(p, seed)| Some(Dropout { p, seed })),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn the_error_bounds_hold(
        width in 1..70_usize,
        hidden in 1..140_usize,
        rows in 0..150_usize,
        dropout in dropouts(),
    ) {
        check(&Case::new(width, hidden, rows, dropout));
    }

    #[test]
    fn derivatives_are_added(hidden in 1..100_usize, rows in 1..80_usize, dropout in dropouts()) {
        let case = Case::new(32, hidden, rows, dropout);
        let layer = case.layer();
        let (_, gx, once) = case.run(&layer);
        let (mut again, mut twice) = (gx.clone(), once.clone());
        layer.backward(&case.x, &case.gy, dropout, &mut again, &mut twice);
        prop_assert_eq!(gx, again);
        let doubled = |sums: &[f32]| -> Vec<f32> { sums.iter().map(|sum| 2.0 * sum).collect() };
        prop_assert_eq!(doubled(&once.w1), twice.w1);
        prop_assert_eq!(doubled(&once.w2), twice.w2);
    }

}
