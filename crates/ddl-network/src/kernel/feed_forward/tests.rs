//! Comparison with the formula in double precision, and properties of any layer.

mod exact;

use crate::kernel::Dropout;
use crate::kernel::feed_forward::FeedForward;
use ddl_simd::{Dispatch, InstructionSet};
use exact::{FeedForwardCase, Sum, UNIT};
use proptest::prelude::*;

/// Each result is within `steps` roundings of the terms of its sum, and within its doubt.
#[track_caller]
fn assert_near(name: &str, results: &[f32], exact: &[Sum], steps: usize) {
    assert_eq!(results.len(), exact.len(), "{name}");
    for (i, (result, Sum { value, size, doubt })) in results.iter().zip(exact).enumerate() {
        let error = (f64::from(*result) - value).abs();
        let bound = steps as f64 * UNIT * size + doubt + 1e-37;
        assert!(error <= bound, "{name}[{i}]: {result} for {value}, {error:e} > {bound:e}");
    }
}

fn layers(case: &FeedForwardCase) -> Vec<FeedForward> {
    let sets = InstructionSet::available();
    assert!(sets.contains(&InstructionSet::Portable));
    let mut layers = vec![case.layer(); sets.len()];
    for (layer, set) in layers.iter_mut().zip(sets) {
        layer.dispatch = Dispatch::new(set).unwrap();
    }
    layers
}

fn check(case: &FeedForwardCase) {
    let exact = case.exact();
    let (width, hidden, rows) = (case.width, case.hidden, case.x.len() / case.width);
    for layer in layers(case) {
        let (y, gx, grads) = case.run(&layer);
        let results = [y, gx, grads.w1, grads.b1, grads.w2, grads.b2];
        for (i, what) in ["y", "gx", "W1", "b1", "W2", "b2"].into_iter().enumerate() {
            let steps = width + [hidden + 8, hidden + 16, rows + 16][i.min(2)];
            let name = format!("{:?}, {what}, {width} x {rows} x {hidden}", layer.dispatch);
            assert_near(&name, &results[i], &exact[i], steps);
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
        check(&FeedForwardCase::new(width, hidden, rows, dropout));
    }
}

#[test]
fn what_is_not_a_number_stays_in_its_row() {
    let mut case = FeedForwardCase::new(32, 64, 12, None);
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
    prop_oneof![Just(None), (0.0..0.95, any::<u64>()).prop_map(|(p, seed)| Some(Dropout { p, seed })),]
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
        check(&FeedForwardCase::new(width, hidden, rows, dropout));
    }

    #[test]
    fn derivatives_are_added(hidden in 1..100_usize, rows in 1..80_usize, dropout in dropouts()) {
        let case = FeedForwardCase::new(32, hidden, rows, dropout);
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
