//! Properties of soft-DTW with a Sakoe-Chiba band.

use ddl_softdtw::{Cost, SearchIndex, SoftDtw};
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

/// The kernel that scores many candidates at once does not support bands, so a search must not use it with a band.
#[test]
fn searches_keep_to_the_band() {
    let candidates: Vec<Sequence> = (0..53)
        .map(|i| {
            let step = |j: i32| [f64::from((i + j) * (i + j) % 11) * 0.2, (f64::from(i + j) * 0.7).sin()];
            (0..8).map(step).collect()
        })
        .collect();
    let query: Sequence = (0..8).map(|i| [f64::from(i % 3) * 0.4, 0.2]).collect();
    for cost in [Cost::SquaredEuclidean, Cost::Euclidean] {
        let dtw = banded(0.5, cost, 1);
        let whole = SoftDtw::new(0.5, cost).unwrap();
        let difference = |y: &Sequence| (dtw.value(&query, y).unwrap() - whole.value(&query, y).unwrap()).abs();
        assert!(
            candidates.iter().map(difference).fold(0.0, f64::max) > 1e-3,
            "the band changes nothing"
        );

        let index = SearchIndex::build(&dtw, &candidates).unwrap();
        let mut distances: Vec<f64> = candidates.iter().map(|y| dtw.normalised(&query, y).unwrap()).collect();
        distances.sort_by(f64::total_cmp);
        for n in [1, 5, 53] {
            let neighbours = index.nearest(&query, n).unwrap();
            assert_eq!(neighbours.len(), n);
            for (neighbour, distance) in neighbours.iter().zip(&distances) {
                assert_eq!(neighbour.distance.to_bits(), distance.to_bits());
            }
        }
    }
}
