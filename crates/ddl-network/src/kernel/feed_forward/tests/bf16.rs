//! The forward pass in bf16, against the formula of rounded numbers in double precision.

use proptest::prelude::*;
use rayon::ThreadPoolBuilder;

use super::exact::Case;
use super::laws::dropouts;
use super::{FeedForward, Gradients, UNIT, assert_near, sets};
use crate::Precision;
use crate::kernel::Dropout;

fn layer(case: &Case, unpacked: FeedForward) -> FeedForward {
    let mut layer = unpacked;
    let weights = [&case.w1, &case.b1, &case.w2, &case.b2].map(|numbers| &numbers[..]);
    layer.update(weights, Precision::Bf16);
    layer
}

/// Emulated with every instruction set, and with what the machine is fastest with.
fn layers(case: &Case) -> Vec<FeedForward> {
    let zeros = || FeedForward::zeros(case.width, case.hidden);
    let emulated = sets().into_iter();
    let emulated = emulated.map(|set| zeros().with_instructions(set).unwrap());
    let all = emulated.chain([zeros()]);
    all.map(|unpacked| layer(case, unpacked)).collect()
}

fn run(case: &Case, layer: &FeedForward) -> Vec<f32> {
    // Overwritten.
    let mut y = vec![f32::NAN; case.x.len()];
    layer.forward(&case.x, case.dropout, &mut y);
    y
}

/// The nearest number with 8 significant bits, ties to even.
fn bf16(value: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let step = 2_f64.powi(value.abs().log2().floor() as i32 - 7);
    (value / step).round_ties_even() * step
}

/// y and what it may be off by: rounding of sums, and activations so near the middle of two bf16 numbers that they may be
/// rounded to either.
fn exact(case: &Case) -> [Vec<f64>; 2] {
    let (width, hidden) = (case.width, case.hidden);
    let rounded = |numbers: &[f32]| -> Vec<f64> {
        let rounded = numbers.iter().map(|&number| bf16(f64::from(number)));
        rounded.collect()
    };
    let [x, w1, w2] = [&case.x, &case.w1, &case.w2].map(|numbers| rounded(numbers));
    let [mut values, mut bounds] = [Vec::new(), Vec::new()];
    for (row, x) in x.chunks_exact(width).enumerate() {
        // Each with the sum of its terms' absolute values, and its doubt.
        let activations: Vec<[f64; 3]> = (0..hidden)
            .map(|j| {
                let b = f64::from(case.b1[j]);
                let terms = w1[j * width..][..width].iter().zip(x).map(|(w, x)| w * x);
                let sum = b + terms.clone().sum::<f64>();
                let size = b.abs() + terms.map(f64::abs).sum::<f64>();
                let factor = case.factor(row, j);
                let (value, size) = (factor * sum.max(0.0), factor * size);
                let off = (width + 4) as f64 * UNIT * size;
                let ends = [value - off, value + off].map(|end| (bf16(end) - bf16(value)).abs());
                // No farther than the computed one, and 2^-8 of that.
                [bf16(value), 1.01 * size, ends[0].max(ends[1])]
            })
            .collect();
        for i in 0..width {
            let b = f64::from(case.b2[i]);
            let [mut value, mut size, mut doubt] = [b, b.abs(), 0.0];
            for (w, [activation, size_of, doubt_of]) in
                w2[i * hidden..][..hidden].iter().zip(&activations)
            {
                value += w * activation;
                size += w.abs() * size_of;
                doubt += w.abs() * doubt_of;
            }
            values.push(value);
            bounds.push((width + hidden + 8) as f64 * UNIT * size + doubt + 1e-37);
        }
    }
    [values, bounds]
}

/// Within the stated bounds, and the same bits, emulated or not.
fn check(case: &Case) {
    let [values, bounds] = exact(case);
    let rows = case.x.len() / case.width;
    let mut first = None;
    for layer in layers(case) {
        let y = run(case, &layer);
        let (width, hidden, way) = (case.width, case.hidden, layer.pair_dispatch);
        let name = format!("{way:?}, {width} x {rows} x {hidden}");
        assert_near(&name, &y, &values, &bounds);
        assert_eq!(first.get_or_insert_with(|| y.clone()), &y, "{name}");
    }
}

#[test]
fn values_are_those_of_the_formula() {
    let dropout = |p| Some(Dropout { p, seed: 11 });
    for (width, hidden) in [(16, 16), (32, 48), (64, 64), (48, 96), (32, 2048)] {
        for rows in [0, 1, 7, 8, 25, 65] {
            check(&Case::new(width, hidden, rows, None));
            check(&Case::new(width, hidden, rows, dropout(0.1)));
        }
    }
    check(&Case::new(33, 300, 531, dropout(0.9)));
}

#[test]
fn bf16_is_bf16() {
    let case = Case::new(32, 256, 40, None);
    let (reference, ..) = case.run(&case.layer());
    let rounded = run(&case, &layers(&case)[0]);
    let norm = |values: &mut dyn Iterator<Item = f32>| values.map(|v| v * v).sum::<f32>().sqrt();
    let difference = norm(&mut reference.iter().zip(&rounded).map(|(a, b)| a - b));
    let relative = difference / norm(&mut reference.iter().copied());
    // Some roundings of up to 2^-9 that add up like noise.
    assert!((1e-3..1e-2).contains(&relative), "{relative}");
}

#[test]
fn what_is_not_a_number_stays_in_its_row() {
    let mut case = Case::new(32, 64, 12, None);
    case.x[5 * 32 + 3] = f32::NAN;
    for layer in layers(&case) {
        for (r, row) in run(&case, &layer).chunks(32).enumerate() {
            let way = layer.pair_dispatch;
            assert!(row.iter().all(|y| y.is_nan() == (r == 5)), "{way:?}, {r}");
        }
    }
}

#[test]
#[should_panic(expected = "a backward pass in bf16")]
fn there_is_no_way_back() {
    let case = Case::new(32, 64, 1, None);
    let mut grads = Gradients::zeros(32, 64);
    layers(&case)[0].backward(&case.x, &case.gy, None, &mut [0.0; 32], &mut grads);
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
    fn the_number_of_threads_changes_no_bit(
        hidden in 1..600_usize,
        rows in 0..700_usize,
        dropout in dropouts(),
    ) {
        let case = Case::new(32, hidden, rows, dropout);
        let layer = layer(&case, FeedForward::zeros(32, hidden));
        let [first, others @ ..] = [1, 2, 3, 7].map(|threads| {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| run(&case, &layer))
        });
        for other in others {
            prop_assert_eq!(&first, &other);
        }
    }

    #[test]
    fn a_row_does_not_see_the_others(rows in 1..80_usize, from in 0..80_usize) {
        let from = from.min(rows);
        let mut case = Case::new(32, 64, rows, None);
        for layer in layers(&case) {
            let all = run(&case, &layer);
            let x = case.x.clone();
            case.x.drain(..from * 32);
            prop_assert_eq!(&all[from * 32..], &run(&case, &layer));
            case.x = x;
        }
    }
}
