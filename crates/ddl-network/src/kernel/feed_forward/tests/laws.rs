//! What must hold for every layer.

use proptest::prelude::*;
use rayon::ThreadPoolBuilder;

use super::exact::Case;
use super::{check, sets};
use crate::kernel::Dropout;
use crate::kernel::feed_forward::dropout::reference;
use crate::kernel::feed_forward::{FeedForward, Gradients};

pub(super) fn dropouts() -> impl Strategy<Value = Option<Dropout>> {
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
    fn the_number_of_threads_changes_no_bit(
        hidden in 1..600_usize,
        rows in 0..700_usize,
        dropout in dropouts(),
    ) {
        let case = Case::new(32, hidden, rows, dropout);
        for set in sets() {
            let layer = case.layer().with_instructions(set).unwrap();
            let mut results = [1, 2, 3, 7].map(|threads| {
                let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| case.run(&layer))
            }).into_iter();
            let first = results.next().unwrap();
            for other in results {
                prop_assert_eq!(&first, &other);
            }
        }
    }

    #[test]
    fn a_row_does_not_see_the_others(rows in 1..80_usize, from in 0..80_usize) {
        let from = from.min(rows);
        let case = Case::new(32, 64, rows, None);
        for set in sets() {
            let layer = case.layer().with_instructions(set).unwrap();
            let (all, ..) = case.run(&layer);
            let mut some = vec![0.0; (rows - from) * 32];
            layer.forward(&case.x[from * 32..], None, &mut some);
            prop_assert_eq!(&all[from * 32..], &some);
        }
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

    /// With W1 and W2 the unit matrix and everything active, y and gx show which units were kept.
    #[test]
    fn both_passes_drop_the_same_units(rows in 1..200_usize, p in 0.01..0.99, seed: u64) {
        const WIDTH: usize = 64;
        let unit: Vec<f32> = (0..WIDTH * WIDTH)
            .map(|i| if i / WIDTH == i % WIDTH { 1.0 } else { 0.0 })
            .collect();
        let zeros = [0.0; WIDTH];
        let layer = FeedForward::pack(&unit, &zeros, &unit, &zeros, WIDTH, WIDTH);
        let dropout = Some(Dropout { p, seed });
        let ones = vec![1.0; rows * WIDTH];
        for set in sets() {
            let layer = layer.clone().with_instructions(set).unwrap();
            let [mut y, mut gx] = [ones.clone(), ones.clone()];
            layer.forward(&ones, dropout, &mut y);
            let mut grads = Gradients::zeros(WIDTH, WIDTH);
            layer.backward(&ones, &ones, dropout, &mut gx, &mut grads);
            prop_assert_eq!(&y, &gx);
            for (i, y) in y.iter().enumerate() {
                let factor = reference::factor(
                    Dropout { p, seed }, i / WIDTH, i % WIDTH,
                );
                prop_assert_eq!(y.to_bits(), (factor as f32).to_bits());
            }
        }
    }
}
