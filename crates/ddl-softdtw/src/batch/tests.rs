use super::{BatchGradients, SoftDtwBatch};
use crate::{Cost, InstructionSet, SoftDtw};

fn walks(count: usize, lengths: &[usize], scale: f64) -> Vec<Vec<[f64; 2]>> {
    let walk = |i: usize| {
        let (sin, cos) = (0.7 * i as f64).sin_cos();
        let speed = scale * 0.017 * (i % 100) as f64;
        let sway = |j: usize| 0.3 * scale * ((i * 31 + j * 17) as f64).sin();
        (0..lengths[i % lengths.len()])
            .map(|j| [speed * cos + sway(j), speed * sin - sway(j + 5)])
            .collect()
    };
    (0..count).map(walk).collect()
}

/// Largest errors of a value and of a component of a gradient, over all instruction sets.
fn worst_errors(dtw: &SoftDtw, xs: &[Vec<[f64; 2]>], ys: &[Vec<[f64; 2]>]) -> (f64, f64) {
    let (mut in_value, mut in_gradient) = (0.0_f64, 0.0_f64);
    for set in InstructionSet::available() {
        let batch = SoftDtwBatch::build(dtw, ys).unwrap();
        let batch = batch.with_instruction_set(set).unwrap();
        let mut results = BatchGradients::default();
        for x in xs {
            batch.values_and_gradients_into(x, &mut results).unwrap();
            assert_eq!(results.gradient(ys.len()), None);
            for (k, y) in ys.iter().enumerate() {
                let (value, gradient) = dtw.value_and_gradient(x, y).unwrap();
                in_value = in_value.max((results.values()[k] - value).abs());
                let found = results.gradient(k).unwrap();
                assert_eq!(found.len(), x.len());
                let pairs = found.as_flattened().iter().zip(gradient.as_flattened());
                in_gradient = pairs.map(|(a, b)| (a - b).abs()).fold(in_gradient, f64::max);
            }
        }
    }
    (in_value, in_gradient)
}

#[test]
fn pedestrians_are_within_the_stated_bounds() {
    let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean).unwrap();
    // For one step against thirty, a component of the gradient sums thirty differences.
    for (lengths, bound) in [(&[8][..], 1e-5), (&[7], 1e-5), (&[1, 2, 5, 12, 30], 5e-5)] {
        let (xs, ys) = (walks(9, lengths, 1.0), walks(333, lengths, 1.0));
        let (value, gradient) = worst_errors(&dtw, &xs, &ys);
        assert!(value < bound && gradient < bound, "{value:e} {gradient:e}");
        assert!(value > 1e-9 && gradient > 1e-9, "not in f32 at all");
    }
}

#[test]
fn what_leaves_the_range_is_evaluated_in_f64() {
    // Some pairs are within the range, others beyond it; there f32 alone would have errors of more than 1.
    let far = walks(60, &[8], 4.0);
    let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean).unwrap();
    let values: Vec<f64> = far.iter().map(|y| dtw.value(&far[37], y).unwrap()).collect();
    assert!(values.iter().any(|&v| v < 40.0) && values.iter().any(|&v| v > 60.0));
    let (value, gradient) = worst_errors(&dtw, &far[30..40], &far);
    // The sequences are four times as long as a pedestrian's, and so are their errors.
    assert!(value < 4e-5 && gradient < 4e-5, "{value:e} {gradient:e}");
    // Only the nearest pairs of the first case fit f32; the last three cases do not fit the exponential domain either.
    for (gamma, cost, scale, length, bound) in [
        (1e-2, Cost::SquaredEuclidean, 1.0, 8, 1e-6),
        (1.0, Cost::SquaredEuclidean, 1.0, 40, 1e-10),
        (1.0, Cost::SquaredEuclidean, 1.0, 170, 1e-9),
        (0.0, Cost::SquaredEuclidean, 1.0, 8, 0.0),
        (0.5, Cost::Euclidean, 1.0, 8, 0.0),
        (1.0, Cost::SquaredEuclidean, 1.0, 200, 0.0),
    ] {
        let dtw = SoftDtw::new(gamma, cost).unwrap();
        let ys = walks(20, &[length], scale);
        let (value, gradient) = worst_errors(&dtw, &ys[10..12], &ys);
        assert!(
            value <= bound && gradient <= bound,
            "{value:e} {gradient:e}, {gamma}, {length}"
        );
    }
}

#[test]
fn a_weighted_sum_is_the_sum() {
    let dtw = SoftDtw::new(0.3, Cost::SquaredEuclidean).unwrap();
    let ys = walks(50, &[8, 5], 1.0);
    let batch = SoftDtwBatch::build(&dtw, &ys).unwrap();
    let weights: Vec<f64> = (0..50).map(|k| 0.1 * f64::from(k)).collect();
    let (sum, gradient) = batch.weighted_sum(&ys[3], &weights).unwrap();
    let each = batch.values_and_gradients(&ys[3]).unwrap();
    let expected: f64 = each.values().iter().zip(&weights).map(|(v, w)| v * w).sum();
    assert!((sum - expected).abs() < 1e-9);
    for (i, step) in gradient.iter().enumerate() {
        for (d, component) in step.iter().enumerate() {
            let terms = (0..50).map(|k| each.gradient(k).unwrap()[i][d] * weights[k]);
            assert!((component - terms.sum::<f64>()).abs() < 1e-9);
        }
    }
}

#[test]
fn bad_input_is_refused_by_name() {
    let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean).unwrap();
    let none: [Vec<[f64; 1]>; 0] = [];
    let build = |ys: &[Vec<[f64; 1]>]| SoftDtwBatch::build(&dtw, ys);
    let batch = build(&[vec![[0.0]], vec![[1e160]]]).unwrap();
    assert_eq!((batch.len(), batch.is_empty()), (2, false));
    let near = build(&[vec![[0.0], [3.0]], vec![[9.0], [1.0]]]).unwrap();
    let sum = |weights: &[f64]| near.weighted_sum(&[[5.0], [2.0]], weights);
    assert!(sum(&[0.5, -2.0]).is_ok());
    for (error, message) in [
        (build(&none).err(), "no candidates"),
        (build(&[vec![[0.0]], vec![[f64::NAN]]]).err(), "candidate 1: "),
        (sum(&[1.0]).err(), "1 weights for 2 sequences: give one for each"),
        (sum(&[1.0, f64::NAN]).err(), "weight 1 is NaN: must be finite"),
        (sum(&[1e308, 1e308]).err(), "query: the soft-DTW value"),
        (batch.values_and_gradients(&[]).err(), "query: sequence x is empty"),
        (batch.values_and_gradients(&[[0.5]]).err(), "candidate 1: the soft-DTW"),
    ] {
        let error = error.expect("refused").to_string();
        assert!(error.starts_with(message), "{error}");
    }
}

#[test]
fn cells_far_from_every_path_leave_nothing_in_a_gradient() {
    // The cheapest path costs 552 γ. A path through the huge difference must not contribute, for any size of the
    // difference.
    let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean).unwrap();
    for huge in [1e5, 1e10, 1e40, 1e100, 1e300] {
        let (x, y) = (vec![[huge], [23.5]], vec![[huge], [0.0], [23.5]]);
        for set in InstructionSet::available() {
            let batch = SoftDtwBatch::build(&dtw, std::slice::from_ref(&y)).unwrap();
            let batch = batch.with_instruction_set(set).unwrap();
            let found = batch.values_and_gradients(&x).unwrap();
            let (value, gradient) = dtw.value_and_gradient(&x, &y).unwrap();
            assert!((found.values()[0] - value).abs() < 1e-9, "{set}, {huge:e}");
            for (found, expected) in found.gradient(0).unwrap().iter().zip(&gradient) {
                assert!((found[0] - expected[0]).abs() < 1e-9, "{set}, {huge:e}: {found:?}");
            }
        }
    }
}
