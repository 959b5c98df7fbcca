//! Against the formula in double precision.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod bf16;
mod exact;
mod laws;

use super::{FeedForward, Gradients};
use crate::kernel::Dropout;
use ddl_simd::InstructionSet;
use exact::Case;

const UNIT: f64 = 1.0 / 16_777_216.0;

fn sets() -> Vec<InstructionSet> {
    let sets = InstructionSet::available();
    assert!(sets.contains(&InstructionSet::Portable));
    sets
}

#[track_caller]
fn assert_near(name: &str, found: &[f32], exact: &[f64], bounds: &[f64]) {
    assert_eq!(found.len(), exact.len(), "{name}");
    for (i, found) in found.iter().enumerate() {
        let error = (f64::from(*found) - exact[i]).abs();
        assert!(
            error <= bounds[i],
            "{name}[{i}]: {found} for {}, {error:e} > {:e}",
            exact[i],
            bounds[i]
        );
    }
}

/// Both passes with every instruction set, within the stated bounds.
fn check(case: &Case) {
    let exact = case.exact();
    let scaled = |steps: usize, [sizes, doubts]: [&[f64]; 2]| -> Vec<f64> {
        let bound = |(size, doubt): (&f64, &f64)| steps as f64 * UNIT * size + doubt + 1e-37;
        sizes.iter().zip(doubts).map(bound).collect()
    };
    let rows = case.x.len() / case.width;
    let (of_y, of_gx) = (case.width + case.hidden + 8, case.width + case.hidden + 16);
    let of_weights = case.width + rows + 16;
    for set in sets() {
        let layer = case.layer().with_instructions(set).unwrap();
        let (y, gx, grads) = case.run(&layer);
        let name =
            |what: &str| format!("{set:?}, {what}, {} x {rows} x {}", case.width, case.hidden);
        let none = vec![0.0; y.len()];
        let bounds = scaled(of_y, [&exact.y.sizes, &none]);
        assert_near(&name("y"), &y, &exact.y.values, &bounds);
        let found = [gx, grads.w1, grads.b1, grads.w2, grads.b2];
        let steps = [of_gx, of_weights, of_weights, of_weights, of_weights];
        for (i, what) in ["gx", "W1", "b1", "W2", "b2"].into_iter().enumerate() {
            let exact = &exact.gradients[i];
            let bounds = scaled(steps[i], [&exact.sizes, &exact.doubts]);
            assert_near(&name(what), &found[i], &exact.values, &bounds);
        }
    }
}

#[test]
fn values_and_gradients_are_those_of_the_formula() {
    let dropout = |p| Some(Dropout { p, seed: 11 });
    for (width, hidden) in [(16, 16), (32, 48), (64, 64), (48, 96), (32, 2048)] {
        for rows in [1, 7, 8, 25, 65] {
            check(&Case::new(width, hidden, rows, None));
            check(&Case::new(width, hidden, rows, dropout(0.1)));
        }
    }
    check(&Case::new(32, 64, 1301, dropout(0.5)));
    check(&Case::new(33, 300, 531, dropout(0.9)));
}

#[test]
fn gradients_are_limits_of_differences() {
    let dropout = Some(Dropout { p: 0.25, seed: 5 });
    for (width, hidden, rows) in [(16, 16, 5), (32, 48, 9)] {
        let case = Case::new(width, hidden, rows, dropout);
        let (_, gx, grads) = case.run(&case.layer());
        let found = [gx, grads.w1, grads.b1, grads.w2, grads.b2];
        for (which, found) in found.iter().enumerate() {
            for at in (0..found.len()).step_by(7) {
                let step = 1e-6;
                let loss = |change: f64| case.loss_with(which, at, change);
                let slope = (loss(step) - loss(-step)) / (2.0 * step);
                let error = (f64::from(found[at]) - slope).abs();
                assert!(error < 2e-5, "{which}, {at}: {} for {slope}", found[at]);
            }
        }
    }
}

#[test]
fn no_rows() {
    let case = Case::new(32, 64, 0, Some(Dropout { p: 0.1, seed: 1 }));
    for set in sets() {
        let (y, gx, grads) = case.run(&case.layer().with_instructions(set).unwrap());
        assert!(y.is_empty() && gx.is_empty());
        assert_eq!(grads, Gradients::zeros(32, 64));
    }
}

#[test]
fn what_is_not_a_number_stays_in_its_row() {
    let mut case = Case::new(32, 64, 12, None);
    case.x[5 * 32 + 3] = f32::NAN;
    for set in sets() {
        let (y, gx, grads) = case.run(&case.layer().with_instructions(set).unwrap());
        for (r, row) in y.chunks(32).enumerate() {
            assert!(row.iter().all(|y| y.is_nan() == (r == 5)), "{set:?}, {r}");
        }
        // As in libtorch, the derivative of ReLU at NaN is 1.
        assert!(gx.iter().all(|gx| gx.is_finite()), "{set:?}");
        assert!(grads.w2.iter().all(|g| g.is_nan()), "{set:?}");
    }
}

#[test]
#[should_panic(expected = "x is not made of rows of 32")]
fn half_a_row() {
    let layer = Case::new(32, 64, 0, None).layer();
    layer.forward(&[0.0; 48], None, &mut [0.0; 48]);
}

#[test]
#[should_panic(expected = "entries of the gradient of W1")]
fn gradients_of_another_layer() {
    let layer = Case::new(32, 64, 0, None).layer();
    let mut grads = Gradients::zeros(32, 32);
    layer.backward(&[0.0; 32], &[0.0; 32], None, &mut [0.0; 32], &mut grads);
}

#[test]
#[should_panic(expected = "dropout of 1: not in [0, 1)")]
fn dropping_all() {
    let layer = Case::new(32, 64, 0, None).layer();
    let dropout = Some(Dropout { p: 1.0, seed: 1 });
    layer.forward(&[0.0; 32], dropout, &mut [0.0; 32]);
}

#[test]
#[should_panic(expected = "entries of W2")]
fn a_matrix_of_another_size() {
    let _: FeedForward = FeedForward::pack(&[0.0; 32], &[0.0], &[0.0; 31], &[0.0; 32], 32, 1);
}
