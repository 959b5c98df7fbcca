//! Laws that hold for any input.

use super::Case;
use crate::kernel::among_pedestrians::queries::LARGE;
use crate::kernel::among_pedestrians::{AmongPedestrians, Attended};
use crate::kernel::tests::numbers::{assert_close, bits, wide};
use crate::kernel::{Dropout, Scenes};
use ddl_simd::InstructionSet;
use proptest::prelude::*;

fn case() -> impl Strategy<Value = Case> {
    let sizes = prop::collection::vec(1_usize..14, 1..5);
    let shape = (sizes, 1_usize..4, any::<bool>(), any::<u64>());
    (shape, prop::option::of(0.0..0.9), 0.1_f32..3.0).prop_map(
        |((sizes, entries, shared, seed), p, bound)| {
            let frames = if shared { 1 } else { entries };
            let mut case = Case::new(seed, (8, 4), &sizes, (entries, frames), bound);
            case.dropout = p.map(|p| Dropout { p, seed });
            case
        },
    )
}

impl std::fmt::Debug for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            sizes,
            entries,
            dropout,
            ..
        } = self;
        write!(f, "{entries} entries of {sizes:?}, {dropout:?}")
    }
}

/// The rows of a batch of one scene in another order.
fn permuted(rows: &[f32], order: &[usize]) -> Vec<f32> {
    let width = rows.len() / order.len();
    order
        .iter()
        .flat_map(|&from| rows[from * width..][..width].iter().copied())
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn values_and_gradients_are_those_of_the_formula(case in case()) {
        let (mixed, gradient) = case.expected();
        let (of_mixed, of_gradient) = case.run(InstructionSet::detect());
        assert_close("mixed", &of_mixed, &mixed, 5e-6);
        assert_close("gradient", &of_gradient, &gradient, 5e-6);
    }

    #[test]
    fn instruction_sets_agree(case in case()) {
        let (mixed, gradient) = case.run(InstructionSet::Portable);
        for set in InstructionSet::available() {
            let (of_mixed, of_gradient) = case.run(set);
            assert_close("mixed", &of_mixed, &wide(&mixed), 3e-6);
            assert_close("gradient", &of_gradient, &wide(&gradient), 3e-6);
        }
    }

    /// A permutation of the pedestrians permutes the output and the gradient.
    #[test]
    fn pedestrians_may_come_in_any_order(
        seed: u64,
        order in (1_usize..30).prop_flat_map(|size| Just((0..size).collect::<Vec<_>>()).prop_shuffle()),
    ) {
        let size = order.len();
        let case = Case::new(seed, (8, 4), &[size], (1, 1), 1.5);
        let mut other = Case::new(seed, (8, 4), &[size], (1, 1), 1.5);
        other.qkv = permuted(&case.qkv, &order);
        other.gradient = permuted(&case.gradient, &order);
        for (i, from) in order.iter().enumerate() {
            for (j, to) in order.iter().enumerate() {
                other.visible[i * size + j] = case.visible[from * size + to];
            }
        }
        let set = InstructionSet::detect();
        let ((mixed, gradient), (of_mixed, of_gradient)) = (case.run(set), other.run(set));
        assert_close("mixed", &of_mixed, &wide(&permuted(&mixed, &order)), 3e-6);
        assert_close("gradient", &of_gradient, &wide(&permuted(&gradient, &order)), 3e-6);
    }

    /// A scene's results do not depend on the scenes beside it.
    #[test]
    fn scenes_do_not_meet(case in case()) {
        prop_assume!(case.dropout.is_none()); // decisions depend on the pedestrian's number
        let set = InstructionSet::detect();
        let (mixed, gradient) = case.run(set);
        let pedestrians: usize = case.sizes.iter().sum();
        let pairs: usize = case.sizes.iter().map(|size| size * size).sum();
        let (mut first, mut pair) = (0, 0);
        for &size in &case.sizes {
            let mut alone = Case::new(0, (8, 4), &[size], (1, 1), 1.0);
            alone.visible = case.visible[pair..pair + size * size].to_vec();
            alone.qkv = case.qkv[first * 96..(first + size) * 96].to_vec();
            alone.gradient = case.gradient[first * 32..(first + size) * 32].to_vec();
            let (of_mixed, of_gradient) = alone.run(set);
            prop_assert_eq!(bits(&of_mixed), bits(&mixed[first * 32..][..size * 32]));
            prop_assert_eq!(bits(&of_gradient), bits(&gradient[first * 96..][..size * 96]));
            first += size;
            pair += size * size;
        }
        prop_assert_eq!((first, pair), (pedestrians, pairs));
    }
}

/// Big enough for more than one thread to work.
#[test]
fn threads_change_no_bit() {
    let mut case = Case::new(11, (8, 4), &[17, 3, 57, 20, 1, 8], (9, 9), 1.5);
    case.dropout = Some(Dropout { p: 0.1, seed: 3 });
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let (mixed, gradient) = pool.unwrap().install(|| case.run(InstructionSet::detect()));
        (bits(&mixed), bits(&gradient))
    };
    let one = run(1);
    for threads in [2, 3, 7] {
        assert!(run(threads) == one, "{threads} threads");
    }
}

/// Buffers of a bigger batch may be used again.
#[test]
fn results_do_not_depend_on_what_was_there() {
    let (big, small) = (
        Case::new(12, (8, 4), &[30, 5], (2, 1), 1.0),
        Case::new(13, (8, 4), &[4, 3], (1, 1), 1.0),
    );
    let attention = AmongPedestrians::new(8, 4);
    let mut attended = Attended::default();
    for case in [&big, &small] {
        let scenes = Scenes::new(&case.sizes, &case.visible);
        attention.forward(&case.qkv, scenes.throughout(), None, &mut attended);
        assert_eq!(attended.mixed(), case.run(InstructionSet::detect()).0);
    }
}

#[test]
#[should_panic(expected = "qkv has 95 numbers")]
fn refuses_rows_that_do_not_fit() {
    let scenes = Scenes::all_visible(&[1]);
    let mut attended = Attended::default();
    AmongPedestrians::new(8, 4).forward(&[0.0; 95], scenes.throughout(), None, &mut attended);
}

#[test]
#[should_panic(expected = "2 frames of visibility for 3 batch entries")]
fn refuses_frames_that_do_not_fit() {
    let scenes = Scenes::new(&[1], &[true; 2]);
    let mut attended = Attended::default();
    AmongPedestrians::new(8, 4).forward(&[0.0; 288], scenes.throughout(), None, &mut attended);
}

/// A scene so large that only who is seen is gone through.
#[test]
fn large_scenes_are_those_of_the_formula() {
    let case = Case::new(21, (8, 4), &[LARGE + 21], (2, 1), 1.5);
    let (mixed, gradient) = case.expected();
    for set in InstructionSet::available() {
        let (of_mixed, of_gradient) = case.run(set);
        assert_close("mixed", &of_mixed, &mixed, 5e-6);
        assert_close("gradient", &of_gradient, &gradient, 5e-6);
    }
}

/// Pedestrians who are seen by nobody of a small scene make it a large one, and change no bit of it.
#[test]
fn who_is_far_away_changes_no_bit() {
    let (near, all) = (LARGE, LARGE + 40);
    let small = Case::new(22, (8, 4), &[near], (1, 1), 1.5);
    let mut large = Case::new(23, (8, 4), &[all], (1, 1), 1.5);
    for (i, j) in (0..all).flat_map(|i| (0..all).map(move |j| (i, j))) {
        large.visible[i * all + j] = match (i < near, j < near) {
            (true, true) => small.visible[i * near + j],
            (false, false) => large.visible[i * all + j],
            _ => false,
        };
    }
    large.qkv[..small.qkv.len()].copy_from_slice(&small.qkv);
    for set in InstructionSet::available() {
        let (of_small, of_large) = (small.run(set).0, large.run(set).0);
        assert!(
            bits(&of_small) == bits(&of_large[..of_small.len()]),
            "{set:?}"
        );
    }
}
