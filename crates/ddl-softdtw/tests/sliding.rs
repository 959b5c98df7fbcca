//! The sliding search against evaluating every window in `f64`.

#![expect(clippy::print_stdout, reason = "says why nothing is compared")]

mod recorded;

use ddl_softdtw::{
    Cost, InstructionSet, SearchIndex, SequenceRole, SlidingError, SlidingIndex, SoftDtw,
    SoftDtwError, WindowNeighbour,
};
use proptest::prelude::*;

type Track<const D: usize> = Vec<[f64; D]>;
type Nearest = Vec<WindowNeighbour>;

/// Distances that differ by less are ties: what `f64` leaves of the log domain.
const TIE: f64 = 1e-9;

/// A stream of numbers in [0, 1): splitmix64.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Velocities (m/s) of a walker who keeps a heading with some sway, and stands still for some of the steps.
    fn walker<const D: usize>(&mut self, steps: usize) -> Track<D> {
        let mean: [f64; D] = std::array::from_fn(|_| 2.0 * self.next() - 1.0);
        let stop = (self.next() * 2.0 * steps as f64) as usize;
        (0..steps)
            .map(|i| {
                let stands = (stop..stop + 12).contains(&i);
                mean.map(|mean| {
                    if stands {
                        0.0
                    } else {
                        mean + 0.3 * (self.next() - 0.5)
                    }
                })
            })
            .collect()
    }

    fn walkers<const D: usize>(&mut self, count: usize, longest: usize) -> Vec<Track<D>> {
        (0..count)
            .map(|_| {
                let steps = (self.next() * (longest + 1) as f64) as usize;
                self.walker(steps)
            })
            .collect()
    }
}

fn squared(gamma: f64) -> SoftDtw {
    SoftDtw::new(gamma, Cost::SquaredEuclidean).expect("valid")
}

/// The windows of `length` steps with `tail` more behind them: track, offset, steps.
fn windows<const D: usize>(
    tracks: &[Track<D>],
    length: usize,
    tail: usize,
) -> Vec<(usize, usize, &[[f64; D]])> {
    let mut windows = Vec::new();
    for (track, steps) in tracks.iter().enumerate() {
        for offset in 0..(steps.len() + 1).saturating_sub(length + tail) {
            windows.push((track, offset, &steps[offset..offset + length]));
        }
    }
    windows
}

/// Every window, nearest first, evaluated one by one in the log domain.
fn brute_force<const D: usize>(
    dtw: SoftDtw,
    candidates: &[(usize, usize, &[[f64; D]])],
    query: &[[f64; D]],
) -> Nearest {
    let mut all: Vec<_> = candidates
        .iter()
        .map(|&(track, offset, steps)| WindowNeighbour {
            track,
            offset,
            distance: dtw.normalised(query, steps).expect("finite"),
        })
        .collect();
    all.sort_by(|a, b| key(a).0.total_cmp(&key(b).0).then(key(a).1.cmp(&key(b).1)));
    all
}

fn key(neighbour: &WindowNeighbour) -> (f64, (usize, usize)) {
    (neighbour.distance, (neighbour.track, neighbour.offset))
}

/// Distances up to ties, order, and the set up to ties with the n-th.
fn assert_same(dtw: SoftDtw, found: &[WindowNeighbour], oracle: &[WindowNeighbour], n: usize) {
    let n = n.min(oracle.len());
    assert_eq!(found.len(), n);
    // The log domain rounds numbers of the size of the distance and of gamma.
    let tie = |distance: f64| TIE * distance.abs().max(1.0) + 1e-13 * dtw.gamma();
    for (found, oracle) in found.iter().zip(oracle) {
        let difference = (found.distance - oracle.distance).abs();
        assert!(difference < tie(oracle.distance), "{found:?} {oracle:?}");
    }
    let Some(last) = n.checked_sub(1) else { return };
    let last = oracle[last].distance;
    let place = |a: &WindowNeighbour| key(a).1;
    for clear in oracle.iter().filter(|o| o.distance < last - tie(last)) {
        let present = found.iter().any(|f| place(f) == place(clear));
        assert!(present, "{clear:?} is missing");
    }
    for found in found {
        let itself = oracle
            .iter()
            .find(|o| place(o) == place(found))
            .expect("a window");
        let difference = (itself.distance - found.distance).abs();
        assert!(difference < tie(itself.distance), "{found:?} {itself:?}");
    }
    let ordered = |p: &[WindowNeighbour]| key(&p[0]) < key(&p[1]);
    assert!(
        found.windows(2).all(ordered),
        "not in order, or a window twice"
    );
}

/// The answer of every instruction set, which must be one answer.
fn search<const D: usize>(index: &SlidingIndex<D>, query: &[[f64; D]], n: usize) -> Vec<Nearest> {
    let answer = |set| {
        let index = index.clone().with_instruction_set(set).expect("available");
        index.nearest_windows(query, n).expect("valid")
    };
    let portable = answer(InstructionSet::Portable);
    for set in InstructionSet::available() {
        assert!(answer(set) == portable, "{set} differs");
    }
    portable
}

/// All windows of all queries against brute force.
fn compare<const D: usize>(
    dtw: SoftDtw,
    tracks: &[Track<D>],
    queries: &[Track<D>],
    (length, tail): (usize, usize),
    n: usize,
) {
    let candidates = windows(tracks, length, tail);
    let index = SlidingIndex::build(&dtw, tracks, length, tail).expect("valid");
    assert_eq!(index.len(), candidates.len());
    for query in queries {
        let found = search(&index, query, n);
        assert_eq!(found.len(), (query.len() + 1).saturating_sub(length));
        for (found, window) in found.iter().zip(query.windows(length)) {
            assert_same(dtw, found, &brute_force(dtw, &candidates, window), n);
        }
        if let Some(window) = query.windows(length).last() {
            let alone = index.nearest(window, n).expect("valid");
            assert_eq!(Some(&alone), found.last(), "one window alone");
        }
    }
}

#[test]
fn walkers_who_also_stand_still() {
    for (seed, length, tail) in [
        (1, 7, 0),
        (2, 8, 0),
        (3, 8, 12),
        (4, 5, 3),
        (5, 1, 0),
        (6, 16, 0),
    ] {
        let mut numbers = Numbers(seed);
        let tracks = numbers.walkers::<2>(90, 60);
        let queries: Vec<Track<2>> = [length, length + 1, 3 * length, 40]
            .map(|steps| numbers.walker(steps))
            .into();
        compare(squared(1.0), &tracks, &queries, (length, tail), 30);
    }
}

#[test]
fn one_dimension_and_three() {
    let mut numbers = Numbers(7);
    let tracks = numbers.walkers::<1>(50, 40);
    compare(squared(1.0), &tracks, &[numbers.walker(21)], (8, 0), 25);
    let tracks = numbers.walkers::<3>(50, 40);
    compare(squared(1.0), &tracks, &[numbers.walker(21)], (7, 0), 25);
}

#[test]
fn long_tracks_and_long_queries_are_cut_without_a_trace() {
    let mut numbers = Numbers(8);
    let tracks = vec![
        numbers.walker::<2>(700),
        vec![],
        numbers.walker(65 + 7),
        numbers.walker(64 + 7),
    ];
    compare(squared(1.0), &tracks, &[numbers.walker(150)], (8, 0), 10);
}

#[test]
fn wherever_the_sieve_cannot_be_trusted_the_answer_is_right() {
    let mut numbers = Numbers(9);
    let tracks = numbers.walkers::<2>(14, 40);
    let queries = [numbers.walker::<2>(12)];
    for gamma in [0.0, 1e-300, 1e-3, 0.01, 0.1, 10.0, 1e6, 1e300] {
        compare(squared(gamma), &tracks, &queries, (8, 0), 20);
    }
    for gamma in [0.0, 0.5] {
        let dtw = SoftDtw::new(gamma, Cost::Euclidean).expect("valid");
        compare(dtw, &tracks, &queries, (8, 0), 20);
    }
    let map = |tracks: &[Track<2>], scale: f64, by: f64| -> Vec<Track<2>> {
        let map = |step: &[f64; 2]| step.map(|v| v * scale + by);
        tracks.iter().map(|t| t.iter().map(map).collect()).collect()
    };
    // Far queries saturate f32, data far from the origin or huge does not fit it.
    for (scale, by) in [(1.0, 5.0), (8.0, 0.0), (1.0, 40.0), (1e3, 0.0), (1e60, 0.0)] {
        compare(squared(1.0), &tracks, &map(&queries, scale, by), (8, 0), 20);
    }
    for (scale, by) in [(1.0, 1e6), (1e5, 0.0), (1e60, 0.0)] {
        let (tracks, queries) = (map(&tracks, scale, by), map(&queries, scale, by));
        compare(squared(1.0), &tracks, &queries, (8, 0), 20);
    }
    // Longer than f32 has paths for, and longer than f64 has.
    let (tracks, query) = (numbers.walkers::<2>(4, 300), numbers.walker::<2>(201));
    compare(squared(1.0), &tracks, &[query[..40].to_vec()], (36, 0), 5);
    compare(squared(1.0), &tracks, &[query], (200, 0), 5);
}

#[test]
fn ties_are_broken_by_track_and_offset() {
    // Everyone stands: all distances are 0.
    let tracks: Vec<Track<2>> = [9, 3, 30, 8, 100].map(|steps| vec![[0.0; 2]; steps]).into();
    let index = SlidingIndex::build(&squared(1.0), &tracks, 8, 0).expect("valid");
    let expected: Vec<_> = windows(&tracks, 8, 0)
        .into_iter()
        .map(|(track, offset, _)| WindowNeighbour {
            track,
            offset,
            distance: 0.0,
        })
        .collect();
    for found in search(&index, &tracks[0], 40) {
        assert_eq!(found, expected[..40]);
    }
}

#[test]
fn more_than_there_are_none_and_one() {
    let mut numbers = Numbers(10);
    let tracks = vec![
        numbers.walker::<2>(5),
        numbers.walker(7 + 20),
        numbers.walker(19),
    ];
    let queries = [numbers.walker::<2>(6), numbers.walker(7), numbers.walker(9)];
    for n in [0, 1, 20, 21, 22, 1000] {
        compare(squared(1.0), &tracks, &queries, (7, 0), n);
    }
    // One window in all.
    compare(
        squared(1.0),
        &[numbers.walker::<2>(11)],
        &queries,
        (7, 4),
        3,
    );
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let mut numbers = Numbers(11);
    let tracks = numbers.walkers::<2>(120, 50);
    let queries = vec![
        numbers.walker::<2>(300),
        vec![],
        numbers.walker(8),
        numbers.walker(30),
    ];
    let index = SlidingIndex::build(&squared(1.0), &tracks, 8, 0).expect("valid");
    let one_by_one: Vec<Vec<Nearest>> = queries
        .iter()
        .map(|query| index.nearest_windows(query, 50).expect("valid"))
        .collect();
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        let batch = pool.install(|| index.nearest_windows_batch(&queries, 50));
        assert!(batch.expect("valid") == one_by_one, "{threads} threads");
        let rebuilt = pool.install(|| SlidingIndex::build(&squared(1.0), &tracks, 8, 0));
        let rebuilt = rebuilt.expect("valid").nearest_windows(&queries[0], 50);
        assert!(
            rebuilt.expect("valid") == one_by_one[0],
            "built with {threads} threads"
        );
    }
}

#[test]
fn bad_input_is_refused_by_name() {
    let dtw = squared(1.0);
    let tracks = [vec![[0.0]; 9], vec![[1.0]; 3]];
    let build = |length, tail| SlidingIndex::build(&dtw, &tracks, length, tail);
    assert_eq!(build(0, 0).unwrap_err(), SlidingError::EmptyWindow);
    let error = build(8, 2).unwrap_err();
    assert_eq!(
        error.to_string(),
        "none of the 2 tracks has a window: one needs 8 steps with 2 more behind it"
    );
    assert!(build(usize::MAX, usize::MAX).is_err());
    let none: [Track<1>; 0] = [];
    assert!(matches!(
        SlidingIndex::build(&dtw, &none, 8, 0).unwrap_err(),
        SlidingError::NoWindows { tracks: 0, .. }
    ));
    let error =
        SlidingIndex::build(&dtw, &[vec![[0.0]], vec![[1.0], [f64::INFINITY]]], 1, 0).unwrap_err();
    let source = SoftDtwError::NonFinite {
        sequence: SequenceRole::Y,
        step: 1,
        component: 0,
        value: f64::INFINITY,
    };
    assert_eq!(error, SlidingError::Track { index: 1, source });

    let index = build(8, 0).expect("one track has windows");
    assert_eq!(
        (index.len(), index.is_empty(), index.window_length()),
        (2, false, 8)
    );
    let error = index.nearest(&[[0.0]; 7], 1).unwrap_err();
    assert_eq!(
        error,
        SlidingError::QueryLength {
            found: 7,
            length: 8
        }
    );
    let mut query = vec![[0.0]; 20];
    query[17] = [f64::NAN];
    let error = index.nearest_windows(&query, 1).unwrap_err();
    assert_eq!(
        error.to_string(),
        "query: sequence x, step 17, component 0 is NaN: must be finite"
    );
    let error = index
        .nearest_windows_batch(&[vec![], query], 1)
        .unwrap_err();
    assert!(
        matches!(error, SlidingError::BatchQuery { index: 1, .. }),
        "{error}"
    );
    // A window out of reach is no obstacle until it has to be returned.
    let far = SlidingIndex::build(&dtw, &[vec![[0.0]; 8], vec![[1e160]; 8]], 8, 0).expect("valid");
    assert_eq!(far.nearest(&[[0.5]; 8], 1).expect("near")[0].track, 0);
    assert_eq!(
        far.nearest(&[[0.5]; 8], 2),
        Err(SlidingError::Query(SoftDtwError::Overflow))
    );
}

/// Real walkers of every scene against the windows of all the others: the answer of an index of the windows one by one.
#[test]
fn recorded_walkers_have_the_neighbours_of_a_plain_index() {
    let Some(folder) = recorded::folder() else {
        let reason = "DDL_DATASETS does not name a folder with the recordings (eth.csv, ...)";
        assert!(std::env::var_os("CI").is_none(), "{reason}");
        println!("not compared on real walkers: {reason}");
        return;
    };
    let mut compared = 0;
    for (scene, length, tail) in [
        ("eth", 7, 12),
        ("hotel", 8, 11),
        ("zara", 7, 12),
        ("univ", 8, 11),
    ] {
        let (queries, tracks) = recorded::split(&folder, scene);
        let dtw = squared(1.0);
        let sliding = SlidingIndex::build(&dtw, &tracks, length, tail).expect("valid");
        let candidates = windows(&tracks, length, tail);
        assert!(candidates.len() > 10_000, "{scene}: {}", candidates.len());
        let sequences: Vec<&[[f64; 2]]> = candidates.iter().map(|&(_, _, steps)| steps).collect();
        let plain = SearchIndex::build(&dtw, &sequences).expect("valid");
        let stride = queries.len() / 6;
        for query in queries.iter().step_by(stride) {
            for (found, window) in search(&sliding, query, 100)
                .iter()
                .zip(query.windows(length))
            {
                let expected: Nearest = plain
                    .nearest(window, 100)
                    .expect("valid")
                    .iter()
                    .map(|neighbour| {
                        let (track, offset, _) = candidates[neighbour.index];
                        let distance = neighbour.distance;
                        WindowNeighbour {
                            track,
                            offset,
                            distance,
                        }
                    })
                    .collect();
                // The plain index numbers the windows in the same order, and both decide by the same f64 values.
                assert_eq!(found, &expected, "{scene}");
                for neighbour in found.iter().step_by(9) {
                    let steps = &tracks[neighbour.track][neighbour.offset..][..length];
                    let exact = dtw.normalised(window, steps).expect("finite");
                    assert!(
                        (exact - neighbour.distance).abs() < 1e-12,
                        "{scene}: {exact}"
                    );
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 1_000, "only {compared} distances were compared");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn search_is_brute_force(
        tracks in prop::collection::vec(
            prop::collection::vec(prop::array::uniform2(-2.0..2.0_f64), 0..40), 1..12),
        query in prop::collection::vec(prop::array::uniform2(-2.0..2.0_f64), 0..30),
        length in prop_oneof![Just(7_usize), Just(8), 1..20_usize],
        tail in 0..6_usize,
        gamma in prop_oneof![Just(0.0), 1e-3..10.0_f64],
        n in 1..60_usize,
    ) {
        if windows(&tracks, length, tail).is_empty() {
            let refused = SlidingIndex::build(&squared(gamma), &tracks, length, tail);
            let refused = matches!(refused, Err(SlidingError::NoWindows { .. }));
            prop_assert!(refused);
        } else {
            compare(squared(gamma), &tracks, &[query], (length, tail), n);
        }
    }

    #[test]
    fn search_is_brute_force_in_one_dimension_and_three(
        seed in any::<u64>(),
        count in 1..20_usize,
        longest in 8..70_usize,
        steps in 0..40_usize,
        length in 1..9_usize,
    ) {
        let mut numbers = Numbers(seed);
        let mut tracks = numbers.walkers::<1>(count, longest);
        tracks.push(numbers.walker(length));
        compare(squared(1.0), &tracks, &[numbers.walker(steps)], (length, 0), 15);
        let mut tracks = numbers.walkers::<3>(count, longest);
        tracks.push(numbers.walker(length));
        compare(squared(1.0), &tracks, &[numbers.walker(steps)], (length, 0), 15);
    }
}
