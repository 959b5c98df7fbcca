//! The error bound, the bits and the range of the values of many pairs.

use ddl_simd::{Dispatch, InstructionSet};

use super::{Pair, PairValue, PairValues};
use crate::range::error_log2_64;
use crate::{Cost, SoftDtw};

type Waves = (Vec<[f64; 2]>, Vec<[f64; 2]>);

/// Pairs of wavy sequences of several lengths; `scale` sets how far apart they are.
fn pairs(count: usize, scale: f64) -> Vec<Waves> {
    let wave = |i: usize, steps: usize| -> Vec<[f64; 2]> {
        (0..steps)
            .map(|j| {
                let phase = (i * 37 + j * 11) as f64;
                [scale * phase.sin(), scale * (1.3 * phase).cos()]
            })
            .collect()
    };
    (0..count)
        .map(|i| (wave(i, 1 + i % 9), wave(7 * i + 3, 1 + i % 8)))
        .collect()
}

fn each_set(dtw: SoftDtw) -> impl Iterator<Item = PairValues> {
    InstructionSet::available()
        .into_iter()
        .filter_map(Dispatch::new)
        .map(move |dispatch| PairValues::new(dtw, dispatch))
}

fn borrowed(pairs: &[Waves]) -> Vec<Pair<'_, 2>> {
    pairs.iter().map(|(x, y)| (&x[..], &y[..])).collect()
}

#[test]
fn known_values_keep_their_error_bound_and_their_bits() {
    let unit = f64::EPSILON / 2.0;
    let mut worst = 0.0_f64;
    for cost in [Cost::SquaredEuclidean, Cost::Euclidean] {
        for (scale, gamma) in [(1.0, 1.0), (0.1, 1.0), (3.0, 0.5), (1e3, 1e6), (0.0, 1e-3)] {
            let dtw = SoftDtw::new(gamma, cost).expect("valid");
            let pairs = pairs(100, scale);
            let pairs = borrowed(&pairs);
            let mut first = None;
            for values in each_set(dtw) {
                let computed = values.of(&pairs);
                for (&(x, y), &value) in pairs.iter().zip(&computed) {
                    let exact = dtw.value_unchecked(x, y);
                    let PairValue::Known(value) = value else {
                        panic!("{scale}, {gamma}: {exact} is beyond {value:?}");
                    };
                    let path = (x.len() + y.len() - 1) as f64;
                    // Eight steps have fewer than 2^16 paths.
                    let spread = exact.max(0.0) / gamma * std::f64::consts::LOG2_E + 16.0 + 30.0;
                    let bound = error_log2_64(path, spread, 2) * std::f64::consts::LN_2;
                    // The reference has rounding errors too: an exponential, a logarithm and a sum in every cell of the
                    // path.
                    let oracle = 4.0 * unit * path * (spread + 1.0);
                    worst = worst.max((value - exact).abs() / gamma / (bound + oracle));
                }
                assert_eq!(*first.get_or_insert_with(|| computed.clone()), computed);
            }
        }
    }
    assert!(worst < 1.0, "an error {worst} times its bound");
    assert!(worst > 1e-4, "the bound is far too wide: {worst}");
}

#[test]
fn what_is_out_of_reach_is_bounded_from_below_and_taken_from_the_log_domain() {
    for gamma in [1e-3, 1e-2, 0.1] {
        let dtw = SoftDtw::new(gamma, Cost::SquaredEuclidean).expect("valid");
        let pairs = pairs(200, 3.0);
        let pairs = borrowed(&pairs);
        for values in each_set(dtw) {
            let mut beyond = 0;
            for (&(x, y), value) in pairs.iter().zip(values.of(&pairs)) {
                if let PairValue::AtLeast(bound) = value {
                    let exact = dtw.value_unchecked(x, y);
                    assert!(exact > bound && bound > 450.0 * gamma, "{exact} {bound}");
                    beyond += 1;
                }
            }
            assert!(beyond > 0, "gamma {gamma}");
            for (&(x, y), value) in pairs.iter().zip(values.all(&pairs)) {
                let exact = dtw.value_unchecked(x, y);
                assert!((value - exact).abs() < 1e-11, "{value} {exact}");
            }
        }
    }
}
