//! Comparison of the forward pass in bf16 with the formula for rounded numbers in double precision.

use super::exact::Case;
use super::{FeedForward, UNIT, assert_near};
use crate::Precision;
use ddl_simd::InstructionSet;

pub(super) fn layers(case: &Case) -> Vec<FeedForward> {
    let zeros = || FeedForward::zeros(case.width, case.hidden);
    let emulated = InstructionSet::available().into_iter();
    let emulated = emulated.map(|set| zeros().with_instructions(set).unwrap());
    emulated
        .chain([zeros()])
        .map(|mut layer| {
            layer.update(case.weights(), Precision::Bf16);
            layer
        })
        .collect()
}

pub(super) fn run(case: &Case, layer: &FeedForward) -> Vec<f32> {
    // The forward pass overwrites it.
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

/// y and the bound of its error: the rounding of sums, and activations so close to the middle of two bf16 numbers that
/// they may be rounded to either.
fn exact(case: &Case) -> [Vec<f64>; 2] {
    let (width, hidden) = (case.width, case.hidden);
    let rounded = |numbers: &[f32]| -> Vec<f64> {
        let rounded = numbers.iter().map(|&number| bf16(f64::from(number)));
        rounded.collect()
    };
    let [x, w1, w2] = [&case.x, &case.w1, &case.w2].map(|numbers| rounded(numbers));
    let [mut values, mut bounds] = [Vec::new(), Vec::new()];
    for (row, x) in x.chunks_exact(width).enumerate() {
        // Each with the sum of its terms' absolute values, and the bound of the ambiguity.
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
                // At most the error of the computed one, and 2^-8 of its size.
                [bf16(value), 1.01 * size, ends[0].max(ends[1])]
            })
            .collect();
        for i in 0..width {
            let b = f64::from(case.b2[i]);
            let [mut value, mut size, mut doubt] = [b, b.abs(), 0.0];
            for (w, [activation, size_of, doubt_of]) in w2[i * hidden..][..hidden].iter().zip(&activations) {
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

pub(super) fn check(case: &Case) {
    let [values, bounds] = exact(case);
    let mut first = None;
    for layer in layers(case) {
        let y = run(case, &layer);
        let name = format!("{:?}", layer.pair_dispatch);
        assert_near(&name, &y, &values, &bounds);
        assert_eq!(first.get_or_insert_with(|| y.clone()), &y, "{name}");
    }
}
