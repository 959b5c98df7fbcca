//! The search against evaluating every candidate in `f64`.

mod walks;

use ddl_softdtw::{Neighbour, SearchIndex, SoftDtw};
use proptest::prelude::*;
use walks::{RandomNumbers, dtw_of, mapped};

type Walk = walks::RandomTrack<2>;

fn brute_force(dtw: SoftDtw, candidates: &[Walk], query: &Walk) -> Vec<Neighbour> {
    let evaluated =
        |(index, y): (usize, &Walk)| Neighbour { index, distance: dtw.normalised(query, y).expect("finite") };
    let mut neighbours: Vec<_> = candidates.iter().enumerate().map(evaluated).collect();
    // Stable: ties stay in the order of their indices.
    neighbours.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    neighbours
}

/// The search computes the same distances, so they have the same bits.
fn compare(gamma: f64, candidates: &[Walk], queries: &[Walk], n: usize) {
    let dtw = dtw_of(gamma);
    let index = SearchIndex::build(&dtw, candidates).expect("valid");
    for query in queries {
        let mut expected = brute_force(dtw, candidates, query);
        expected.truncate(n);
        assert_eq!(index.nearest(query, n).expect("valid"), expected);
    }
}

#[test]
fn wherever_the_sieve_cannot_be_trusted_the_answer_is_right() {
    let mut numbers = RandomNumbers::seeded(4);
    let candidates: Vec<Walk> = (0..300).map(|_| numbers.pedestrian(8)).collect();
    let queries: Vec<Walk> = (0..4).map(|_| numbers.pedestrian(8)).collect();
    for gamma in [0.0, 1e-300, 1e-3, 0.01, 0.1, 10.0, 1e6, 1e300] {
        compare(gamma, &candidates, &queries, 20);
    }
    // Far queries saturate f32; huge data and data far from the origin do not fit it.
    for (scale, by) in [(1.0, 5.0), (8.0, 0.0)] {
        compare(1.0, &candidates, &mapped(&queries, scale, by), 20);
    }
    for (scale, by) in [(1.0, 1e6), (1e5, 0.0), (1e60, 0.0)] {
        let (candidates, queries) = (mapped(&candidates, scale, by), mapped(&queries, scale, by));
        compare(1.0, &candidates, &queries, 20);
    }
    // Standing pedestrians, of whom hundreds are nearly equal.
    let standing: Vec<Walk> = (0..1000).map(|_| numbers.standing(8)).collect();
    compare(1.0, &standing, &standing[..4], 100);
    // So long that the number of paths exceeds the range of f32.
    let long: Vec<Walk> = (0..60).map(|i| numbers.pedestrian(30 + i % 5)).collect();
    compare(1.0, &long, &[numbers.pedestrian(31)], 10);
}

#[test]
fn threads_and_company_change_nothing() {
    let mut numbers = RandomNumbers::seeded(8);
    let mut candidates: Vec<Walk> = (0..900).map(|i| numbers.pedestrian(1 + i % 12)).collect();
    candidates.extend((0..900).map(|i| numbers.standing(7 + i % 2)));
    let mut queries: Vec<Walk> = (0..8).map(|i| numbers.pedestrian(3 + i)).collect();
    queries.extend((0..8).map(|_| numbers.standing(8)));
    // One query is too far for the sieve, and one too far for the exponential domain.
    queries.push(vec![[12.0, 0.0]; 8]);
    queries.push(vec![[90.0, 0.0]; 8]);
    for gamma in [1.0, 0.02, 0.0] {
        let index = SearchIndex::build(&dtw_of(gamma), &candidates).unwrap();
        let expected: Vec<_> = queries.iter().map(|q| index.nearest(q, 70).unwrap()).collect();
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let neighbours = pool.unwrap().install(|| index.nearest_batch(&queries, 70)).unwrap();
            assert_eq!(neighbours, expected, "{threads} threads, gamma {gamma}");
        }
    }
}

#[test]
fn bad_input_is_refused_by_name() {
    let dtw = dtw_of(1.0);
    let none: [Walk; 0] = [];
    let index = SearchIndex::build(&dtw, &[vec![[0.0]], vec![[1e160]]]).unwrap();
    // A candidate whose distance overflows is an error only if it must be returned.
    assert_eq!(index.nearest(&[[0.5]], 1).unwrap()[0].index, 0);
    assert_eq!(index.nearest(&[[0.5]], 0), Ok(vec![]));
    assert_eq!((index.len(), index.is_empty()), (2, false));
    for (error, message) in [
        (SearchIndex::build(&dtw, &none).err(), "no candidates were given"),
        (SearchIndex::build(&dtw, &[vec![[0.0]], vec![]]).err(), "candidate 1: sequence y is empty"),
        (index.nearest(&[[f64::NAN]], 1).err(), "query: sequence x, step 0, component 0 is NaN: must be finite"),
        (index.nearest_batch(&[vec![[0.0]], vec![]], 1).err(), "query 1 of the batch: sequence x is empty"),
        (index.nearest(&[[0.5]], 2).err(), "query: the soft-DTW value or gradient leaves the range"),
    ] {
        let error = error.expect("refused").to_string();
        assert!(error.starts_with(message), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn search_is_brute_force(
        candidates in prop::collection::vec(
            prop::collection::vec(prop::array::uniform2(-2.0..2.0_f64), 1..9), 1..80),
        query in prop::collection::vec(prop::array::uniform2(-2.0..2.0_f64), 1..9),
        gamma in prop_oneof![Just(0.0), 1e-3..10.0_f64],
        n in 1..40_usize,
    ) {
        compare(gamma, &candidates, &[query], n);
    }
}
