//! The sliding search must agree with a plain search of the same windows to the last bit.

#![expect(clippy::print_stdout, reason = "says why nothing is compared")]

mod recorded;
mod walks;

use ddl_softdtw::{Cost, InstructionSet, SearchIndex, SlidingIndex, SoftDtw, WindowNeighbour};
use proptest::prelude::*;
use walks::{Numbers, Track, mapped, squared};

type Nearest = Vec<WindowNeighbour>;

/// The windows of `length` steps that are followed by `tail` more steps: track, offset, steps.
fn windows<const D: usize>(tracks: &[Track<D>], (length, tail): (usize, usize)) -> Vec<(usize, usize, &[[f64; D]])> {
    let mut windows = Vec::new();
    for (track, steps) in tracks.iter().enumerate() {
        for offset in 0..(steps.len() + 1).saturating_sub(length + tail) {
            windows.push((track, offset, &steps[offset..offset + length]));
        }
    }
    windows
}

/// Compares all windows of all queries, with every instruction set. Returns the number of neighbours.
fn compare<const D: usize>(
    dtw: SoftDtw,
    tracks: &[Track<D>],
    queries: &[Track<D>],
    (length, tail): (usize, usize),
    n: usize,
) -> usize {
    let candidates = windows(tracks, (length, tail));
    let sequences: Vec<_> = candidates.iter().map(|&(_, _, steps)| steps).collect();
    let plain = SearchIndex::build(&dtw, &sequences).expect("valid");
    let index = SlidingIndex::build(&dtw, tracks, length, tail).expect("valid");
    assert_eq!(index.len(), candidates.len());
    let mut compared = 0;
    for query in queries {
        let expected = query.windows(length).map(|window| -> Nearest {
            let nearest = plain.nearest(window, n).expect("valid");
            // Both number the windows in the same order.
            let neighbour = |found: &ddl_softdtw::Neighbour| WindowNeighbour {
                track: candidates[found.index].0,
                offset: candidates[found.index].1,
                distance: found.distance,
            };
            nearest.iter().map(neighbour).collect()
        });
        let expected: Vec<Nearest> = expected.collect();
        for set in InstructionSet::available() {
            let index = index.clone().with_instruction_set(set).expect("available");
            assert_eq!(index.instruction_set(), set);
            let found = index.nearest_windows(query, n).expect("valid");
            assert!(found == expected, "{set}, {length} steps");
        }
        if let Some(window) = query.windows(length).last() {
            let alone = index.nearest(window, n).expect("valid");
            assert_eq!(Some(&alone), expected.last(), "one window alone");
        }
        compared += expected.iter().map(Vec::len).sum::<usize>();
    }
    compared
}

#[test]
fn long_tracks_and_long_queries_are_cut_without_a_trace() {
    let mut numbers = Numbers(8);
    let mut tracks = [700, 0, 65 + 7, 64 + 7]
        .map(|steps| numbers.pedestrian::<2>(steps))
        .to_vec();
    compare(squared(1.0), &tracks, &[numbers.pedestrian(150)], (8, 0), 10);
    // All pedestrians stand, so all distances are 0.
    tracks.iter_mut().flatten().for_each(|step| *step = [0.0; 2]);
    compare(squared(1.0), &tracks, &[vec![[0.0; 2]; 9]], (8, 0), 40);
}

#[test]
fn wherever_the_sieve_cannot_be_trusted_the_answer_is_right() {
    let mut numbers = Numbers(9);
    let tracks = numbers.pedestrians::<2>(14, 40);
    let queries = [numbers.pedestrian::<2>(12)];
    for gamma in [0.0, 1e-300, 1e-3, 0.01, 0.1, 10.0, 1e6, 1e300] {
        compare(squared(gamma), &tracks, &queries, (8, 0), 20);
    }
    for gamma in [0.0, 0.5] {
        let dtw = SoftDtw::new(gamma, Cost::Euclidean).expect("valid");
        compare(dtw, &tracks, &queries, (8, 0), 20);
    }
    // Far queries saturate f32; huge data and data far from the origin do not fit it.
    for (scale, by) in [(1.0, 5.0), (8.0, 0.0), (1.0, 40.0), (1e3, 0.0), (1e60, 0.0)] {
        compare(squared(1.0), &tracks, &mapped(&queries, scale, by), (8, 0), 20);
    }
    for (scale, by) in [(1.0, 1e6), (1e5, 0.0), (1e60, 0.0)] {
        let (tracks, queries) = (mapped(&tracks, scale, by), mapped(&queries, scale, by));
        compare(squared(1.0), &tracks, &queries, (8, 0), 20);
    }
    // So long that the number of paths exceeds the range of f32, and so long that it exceeds the range of f64.
    let (tracks, query) = (numbers.pedestrians::<2>(4, 300), numbers.pedestrian::<2>(201));
    compare(squared(1.0), &tracks, &[query[..40].to_vec()], (36, 0), 5);
    compare(squared(1.0), &tracks, &[query], (200, 0), 5);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let mut numbers = Numbers(11);
    let tracks = numbers.pedestrians::<2>(120, 50);
    let queries = [300, 0, 8, 30].map(|steps| numbers.pedestrian::<2>(steps));
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let index = SlidingIndex::build(&squared(1.0), &tracks, 8, 0).expect("valid");
            let batch = index.nearest_windows_batch(&queries, 50).expect("valid");
            let single = index.nearest_windows(&queries[0], 50).expect("valid");
            assert!(batch[0] == single, "{threads} threads");
            batch
        })
    });
    assert!(one == three);
}

#[test]
fn bad_input_is_refused_by_name() {
    let dtw = squared(1.0);
    let tracks = [vec![[0.0]; 9], vec![[1.0]; 3]];
    let build = |length, tail| SlidingIndex::build(&dtw, &tracks, length, tail);
    let index = build(8, 0).expect("one track has windows");
    let sizes = (index.len(), index.is_empty(), index.window_length());
    assert_eq!(sizes, (2, false, 8));
    let none: [Track<1>; 0] = [];
    let infinite = [vec![[0.0]], vec![[1.0], [f64::INFINITY]]];
    let mut query = vec![[0.0]; 20];
    query[17] = [f64::NAN];
    let batch = [vec![], query.clone()];
    // A window whose distance overflows is an error only if it must be returned.
    let far = SlidingIndex::build(&dtw, &[vec![[0.0]; 8], vec![[1e160]; 8]], 8, 0).expect("valid");
    assert_eq!(far.nearest(&[[0.5]; 8], 1).expect("near")[0].track, 0);
    for (error, message) in [
        (build(0, 0).err(), "the window length is 0"),
        (
            build(8, 2).err(),
            "none of the 2 tracks has a window: one needs 8 steps with 2 more behind it",
        ),
        (build(usize::MAX, usize::MAX).err(), "none of the 2 tracks"),
        (SlidingIndex::build(&dtw, &none, 8, 0).err(), "none of the 0 tracks"),
        (
            SlidingIndex::build(&dtw, &infinite, 1, 0).err(),
            "track 1: sequence y, step 1, component 0 is inf: must be finite",
        ),
        (
            index.nearest(&[[0.0]; 7], 1).err(),
            "the query has 7 steps: the windows of this index have 8",
        ),
        (
            index.nearest_windows(&query, 1).err(),
            "query: sequence x, step 17, component 0 is NaN: must be finite",
        ),
        (
            index.nearest_windows_batch(&batch, 1).err(),
            "query track 1 of the batch: sequence x, step 17",
        ),
        (
            far.nearest(&[[0.5]; 8], 2).err(),
            "query: the soft-DTW value or gradient leaves the range",
        ),
    ] {
        let error = error.expect("refused").to_string();
        assert!(error.starts_with(message), "{error}");
    }
}

#[test]
fn recorded_pedestrians_have_the_neighbours_of_a_plain_index() {
    let Some(dataset) = recorded::dataset() else {
        let reason = "the recordings are not there (DDL_DATASETS names their folder)";
        assert!(std::env::var_os("CI").is_none(), "{reason}");
        println!("not compared on real pedestrians: {reason}");
        return;
    };
    let scenes: [(&[&str], usize, usize); 4] = [
        (&["eth"], 7, 12),
        (&["hotel"], 8, 11),
        (&["zara01", "zara02", "zara03"], 7, 12),
        (&["students001", "students003", "uni_examples"], 8, 11),
    ];
    let compared = scenes.map(|(scene, length, tail)| {
        let [queries, tracks] = recorded::split(&dataset, scene);
        let stride = queries.len() / 6;
        let queries: Vec<_> = queries.into_iter().step_by(stride).collect();
        compare(squared(1.0), &tracks, &queries, (length, tail), 100)
    });
    assert!(compared.iter().sum::<usize>() > 10_000, "{compared:?} neighbours");
}

fn any_dimension<const D: usize>(numbers: &mut Numbers, window: (usize, usize), gamma: f64, n: usize) {
    let mut tracks = numbers.pedestrians::<D>(30, 70);
    // At least one window.
    tracks.push(numbers.pedestrian(window.0 + window.1));
    let queries = [window.0 - 1, window.0, window.0 + 1, 40].map(|steps| numbers.pedestrian(steps));
    compare(squared(gamma), &tracks, &queries, window, n);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn search_is_that_of_a_plain_index(
        seed in any::<u64>(),
        dimension in 1..4,
        length in prop_oneof![Just(7_usize), Just(8), 1..20_usize],
        tail in prop_oneof![Just(0), 0..12_usize],
        gamma in prop_oneof![Just(0.0), Just(1.0), 1e-3..10.0_f64],
        n in 0..60_usize,
    ) {
        let (mut numbers, window) = (Numbers(seed), (length, tail));
        match dimension {
            1 => any_dimension::<1>(&mut numbers, window, gamma, n),
            2 => any_dimension::<2>(&mut numbers, window, gamma, n),
            _ => any_dimension::<3>(&mut numbers, window, gamma, n),
        }
    }
}
