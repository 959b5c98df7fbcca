//! Properties of soft-DTW with a Sakoe-Chiba band.

use ddl_softdtw::{Cost, SearchIndex, SlidingIndex, SoftDtw, SoftDtwBatch};
use proptest::prelude::*;

use crate::{Sequence, cost, sequence};

fn banded(gamma: f64, cost: Cost, radius: usize) -> SoftDtw {
    crate::banded(gamma, cost, Some(radius))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_narrower_band_raises_it_and_a_wide_one_changes_nothing(
        x in sequence(2.0, 30), y in sequence(2.0, 30), gamma in 0.0..3.0_f64, cost in cost(),
    ) {
        let free = SoftDtw::new(gamma, cost)?;
        let shorter = x.len().min(y.len());
        for wide in [shorter - 1, shorter, usize::MAX] {
            let value = banded(gamma, cost, wide).value(&x, &y)?;
            prop_assert_eq!(value.to_bits(), free.value(&x, &y)?.to_bits());
            let (value, of_x, of_y) = banded(gamma, cost, wide).value_and_gradients(&x, &y)?;
            let (free_value, free_of_x, free_of_y) = free.value_and_gradients(&x, &y)?;
            prop_assert_eq!(value.to_bits(), free_value.to_bits());
            prop_assert_eq!((of_x, of_y), (free_of_x, free_of_y));
        }
        let mut wider = free.value(&x, &y)?;
        for radius in (0..shorter).rev() {
            let value = banded(gamma, cost, radius).value(&x, &y)?;
            prop_assert!(value >= wider - 1e-12 * (1.0 + wider.abs()), "radius {}", radius);
            wider = value;
        }
    }
}

/// The kernels that compute many pairs at once do not support bands, so they must not be used with a band.
#[test]
fn batches_and_searches_keep_to_the_band() {
    let track: Sequence = (0..60)
        .map(|i| [(f64::from(i * i % 11)) * 0.2, (f64::from(i) * 0.7).sin()])
        .collect();
    let windows: Vec<Sequence> = track.windows(8).map(<[_]>::to_vec).collect();
    let query: Sequence = (0..8).map(|i| [f64::from(i % 3) * 0.4, 0.2]).collect();
    for cost in [Cost::SquaredEuclidean, Cost::Euclidean] {
        let dtw = banded(0.5, cost, 1);
        let whole = SoftDtw::new(0.5, cost).unwrap();
        let batch = SoftDtwBatch::build(&dtw, &windows).unwrap();
        let found = batch.values_and_gradients(&query).unwrap();
        for (i, y) in windows.iter().enumerate() {
            let (value, gradient) = dtw.value_and_gradient(&query, y).unwrap();
            assert!((found.values()[i] - value).abs() < 1e-5, "{cost:?}, {i}");
            let of_batch = found.gradient(i).unwrap();
            for (a, b) in of_batch.iter().flatten().zip(gradient.iter().flatten()) {
                assert!((a - b).abs() < 1e-5, "{cost:?}, {i}: {a} {b}");
            }
        }
        let apart = |y: &Sequence| (dtw.value(&query, y).unwrap() - whole.value(&query, y).unwrap()).abs();
        assert!(
            windows.iter().map(apart).fold(0.0, f64::max) > 1e-3,
            "the band changes nothing"
        );

        let sliding = SlidingIndex::build(&dtw, std::slice::from_ref(&track), 8, 0).unwrap();
        let plain = SearchIndex::build(&dtw, &windows).unwrap();
        let mut nearest: Vec<f64> = windows.iter().map(|y| dtw.normalised(&query, y).unwrap()).collect();
        nearest.sort_by(f64::total_cmp);
        for n in [1, 5, 53] {
            let expected = plain.nearest(&query, n).unwrap();
            for (found, nearest) in expected.iter().zip(&nearest) {
                assert_eq!(found.distance.to_bits(), nearest.to_bits());
            }
            let found = sliding.nearest(&query, n).unwrap();
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                assert_eq!((found.track, found.offset), (0, expected.index));
                assert_eq!(found.distance.to_bits(), expected.distance.to_bits());
            }
        }
    }
}
