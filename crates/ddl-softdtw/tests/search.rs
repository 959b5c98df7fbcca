//! The search against evaluating every candidate in `f64`.

use ddl_softdtw::{
    Cost, InstructionSet, Neighbour, SearchError, SearchIndex, SoftDtw, SoftDtwError,
};
use proptest::prelude::*;

type Walk = Vec<[f64; 2]>;

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

    /// Velocities (m/s) of a walker at a walking pace with some sway.
    fn walker(&mut self, steps: usize) -> Walk {
        let (speed, heading) = (0.3 + 1.4 * self.next(), std::f64::consts::TAU * self.next());
        let (sin, cos) = heading.sin_cos();
        (0..steps)
            .map(|_| {
                [
                    speed * cos + 0.3 * (self.next() - 0.5),
                    speed * sin + 0.3 * (self.next() - 0.5),
                ]
            })
            .collect()
    }

    /// Velocities of someone who stands: half of them exactly 0, the rest a multiple of a millimetre a second.
    fn standing(&mut self, steps: usize) -> Walk {
        let still = self.next() < 0.5;
        let mut jitter = || {
            if still {
                0.0
            } else {
                (self.next() * 4.0).floor() * 1e-3
            }
        };
        (0..steps).map(|_| [jitter(), jitter()]).collect()
    }
}

fn brute_force(dtw: &SoftDtw, candidates: &[Walk], query: &Walk) -> Vec<Neighbour> {
    let mut all: Vec<Neighbour> = candidates
        .iter()
        .enumerate()
        .map(|(index, y)| Neighbour {
            index,
            distance: dtw.normalised(query, y).expect("finite"),
        })
        .collect();
    all.sort_by(|a, b| {
        a.distance
            .total_cmp(&b.distance)
            .then(a.index.cmp(&b.index))
    });
    all
}

/// Distances to `tolerance`, and the set up to ties within `tolerance` of the n-th distance.
fn assert_same(found: &[Neighbour], oracle: &[Neighbour], n: usize, tolerance: f64) {
    let n = n.min(oracle.len());
    assert_eq!(found.len(), n);
    for (found, oracle) in found.iter().zip(oracle) {
        assert!(
            (found.distance - oracle.distance).abs() < tolerance,
            "{found:?} {oracle:?}"
        );
    }
    let last = oracle[n - 1].distance;
    for clear in oracle.iter().filter(|o| o.distance < last - tolerance) {
        assert!(
            found.iter().any(|f| f.index == clear.index),
            "{clear:?} is missing"
        );
    }
    for found in found {
        let itself = oracle
            .iter()
            .find(|o| o.index == found.index)
            .expect("a candidate");
        assert!((itself.distance - found.distance).abs() < tolerance);
    }
    let ordered = |p: &[Neighbour]| (p[0].distance, p[0].index) < (p[1].distance, p[1].index);
    assert!(
        found.windows(2).all(ordered),
        "not in order, or a candidate twice"
    );
}

fn compare(dtw: SoftDtw, candidates: &[Walk], queries: &[Walk], n: usize) {
    let index = SearchIndex::build(&dtw, candidates).expect("valid");
    // A distance is a small difference of values of the size of gamma.
    let tolerance = 1e-9_f64.max(1e-13 * dtw.gamma());
    for query in queries {
        assert_same(
            &index.nearest(query, n).expect("valid"),
            &brute_force(&dtw, candidates, query),
            n,
            tolerance,
        );
    }
}

fn squared(gamma: f64) -> SoftDtw {
    SoftDtw::new(gamma, Cost::SquaredEuclidean).expect("valid")
}

#[test]
fn walkers_and_standing_people_with_many_ties() {
    for (seed, steps) in [(1, 7), (2, 8), (3, 12)] {
        let mut numbers = Numbers(seed);
        let mut candidates: Vec<Walk> = (0..1500).map(|_| numbers.walker(steps)).collect();
        candidates.extend((0..700).map(|_| numbers.standing(steps)));
        let mut queries: Vec<Walk> = (0..6).map(|_| numbers.walker(steps)).collect();
        queries.extend((0..6).map(|_| numbers.standing(steps)));
        queries.push(candidates[17].clone());
        compare(squared(1.0), &candidates, &queries, 100);
    }
}

#[test]
fn wherever_the_sieve_cannot_be_trusted_the_answer_is_right() {
    let mut numbers = Numbers(4);
    let candidates: Vec<Walk> = (0..300).map(|_| numbers.walker(8)).collect();
    let queries: Vec<Walk> = (0..4).map(|_| numbers.walker(8)).collect();
    for gamma in [0.0, 1e-300, 1e-3, 0.01, 0.1, 10.0, 1e6, 1e300] {
        compare(squared(gamma), &candidates, &queries, 20);
    }
    for gamma in [0.0, 0.5] {
        compare(
            SoftDtw::new(gamma, Cost::Euclidean).unwrap(),
            &candidates,
            &queries,
            20,
        );
    }
    // Far queries saturate f32, data far from the origin or huge does not fit it.
    let map = |walks: &[Walk], scale: f64, by: f64| -> Vec<Walk> {
        walks
            .iter()
            .map(|w| w.iter().map(|p| p.map(|v| v * scale + by)).collect())
            .collect()
    };
    compare(squared(1.0), &candidates, &map(&queries, 1.0, 5.0), 20);
    compare(squared(1.0), &candidates, &map(&queries, 8.0, 0.0), 20);
    compare(
        squared(1.0),
        &map(&candidates, 1.0, 1e6),
        &map(&queries, 1.0, 1e6),
        20,
    );
    compare(
        squared(1.0),
        &map(&candidates, 1e5, 0.0),
        &map(&queries, 1e5, 0.0),
        20,
    );
    compare(
        squared(1.0),
        &map(&candidates, 1e60, 0.0),
        &map(&queries, 1e60, 0.0),
        20,
    );
}

#[test]
fn lengths_may_differ_and_be_long() {
    let mut numbers = Numbers(5);
    let candidates: Vec<Walk> = (0..200).map(|i| numbers.walker(1 + i % 11)).collect();
    let queries: Vec<Walk> = [1, 5, 20].map(|steps| numbers.walker(steps)).into();
    compare(squared(1.0), &candidates, &queries, 30);
    let long: Vec<Walk> = (0..60).map(|i| numbers.walker(30 + i % 5)).collect();
    compare(squared(1.0), &long, &[numbers.walker(31)], 10);
}

#[test]
fn more_than_there_are_none_and_one() {
    let mut numbers = Numbers(6);
    let candidates: Vec<Walk> = (0..37).map(|_| numbers.walker(7)).collect();
    let query = vec![numbers.walker(7)];
    for n in [1, 36, 37, 1000] {
        compare(squared(1.0), &candidates, &query, n);
    }
    let index = SearchIndex::build(&squared(1.0), &candidates).unwrap();
    assert_eq!(index.nearest(&query[0], 0), Ok(vec![]));
    assert_eq!((index.len(), index.is_empty()), (37, false));
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let mut numbers = Numbers(7);
    let candidates: Vec<Walk> = (0..800).map(|_| numbers.standing(7)).collect();
    let queries: Vec<Walk> = (0..20).map(|_| numbers.standing(7)).collect();
    let index = SearchIndex::build(&squared(1.0), &candidates).unwrap();
    let one_by_one: Vec<_> = queries
        .iter()
        .map(|q| index.nearest(q, 50).unwrap())
        .collect();
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let batch = pool.install(|| index.nearest_batch(&queries, 50)).unwrap();
        assert_eq!(batch, one_by_one);
    }
}

/// Neighbours with the bits of their distances.
fn bits(found: &[Neighbour]) -> Vec<(usize, u64)> {
    found
        .iter()
        .map(|n| (n.index, n.distance.to_bits()))
        .collect()
}

#[test]
fn the_instruction_set_changes_nothing() {
    let mut numbers = Numbers(8);
    let mut candidates: Vec<Walk> = (0..900).map(|i| numbers.walker(1 + i % 12)).collect();
    candidates.extend((0..900).map(|i| numbers.standing(7 + i % 2)));
    let mut queries: Vec<Walk> = (0..8).map(|i| numbers.walker(3 + i)).collect();
    queries.extend((0..8).map(|_| numbers.standing(8)));
    // One too far for the sieve, one too far for the exponential domain.
    queries.push(vec![[12.0, 0.0]; 8]);
    queries.push(vec![[90.0, 0.0]; 8]);
    for (gamma, cost) in [
        (1.0, Cost::SquaredEuclidean),
        (0.02, Cost::SquaredEuclidean),
        (0.5, Cost::Euclidean),
        (0.0, Cost::SquaredEuclidean),
    ] {
        let dtw = SoftDtw::new(gamma, cost).unwrap();
        let index = SearchIndex::build(&dtw, &candidates).unwrap();
        assert_eq!(index.instruction_set(), InstructionSet::detect());
        let expected: Vec<_> = queries
            .iter()
            .map(|q| bits(&index.nearest(q, 70).unwrap()))
            .collect();
        for set in InstructionSet::available() {
            let index = index.clone().with_instruction_set(set).unwrap();
            assert_eq!(index.instruction_set(), set);
            let found = index.nearest_batch(&queries, 70).unwrap();
            let found: Vec<_> = found.iter().map(|found| bits(found)).collect();
            assert_eq!(found, expected, "{set}, gamma {gamma}");
        }
    }
}

#[test]
fn an_instruction_set_the_machine_lacks_is_refused() {
    let index = SearchIndex::build(&squared(1.0), &[vec![[0.0]]]).unwrap();
    for set in [
        InstructionSet::Portable,
        InstructionSet::Avx2,
        InstructionSet::Avx512,
    ] {
        let chosen = index.clone().with_instruction_set(set);
        assert_eq!(chosen.is_ok(), set.is_available());
        if let Err(error) = chosen {
            assert_eq!(error, SearchError::InstructionSet { set });
        }
    }
}

#[test]
fn equal_sequences_are_at_distance_zero() {
    let mut numbers = Numbers(9);
    let candidates: Vec<Walk> = (0..50).map(|i| numbers.walker(1 + i % 9)).collect();
    for gamma in [0.0, 1e-4, 1.0] {
        let index = SearchIndex::build(&squared(gamma), &candidates).unwrap();
        for (i, candidate) in candidates.iter().enumerate() {
            let nearest = index.nearest(candidate, 2).unwrap();
            assert_eq!(bits(&nearest[..1]), [(i, 0.0_f64.to_bits())]);
        }
    }
}

#[test]
fn bad_input_is_refused_by_name() {
    let dtw = squared(1.0);
    let none: [Walk; 0] = [];
    assert_eq!(
        SearchIndex::build(&dtw, &none).unwrap_err(),
        SearchError::NoCandidates
    );
    let error = SearchIndex::build(&dtw, &[vec![[0.0]], vec![]]).unwrap_err();
    assert!(
        matches!(error, SearchError::Candidate { index: 1, .. }),
        "{error}"
    );
    let index = SearchIndex::build(&dtw, &[vec![[0.0]], vec![[1e160]]]).unwrap();
    let error = index.nearest(&[[f64::NAN]], 1).unwrap_err();
    assert_eq!(
        error.to_string(),
        "query: sequence x, step 0, component 0 is NaN: must be finite"
    );
    let error = index.nearest_batch(&[vec![[0.0]], vec![]], 1).unwrap_err();
    assert!(
        matches!(error, SearchError::BatchQuery { index: 1, .. }),
        "{error}"
    );
    // A candidate out of reach is no obstacle until it has to be returned.
    assert_eq!(index.nearest(&[[0.5]], 1).unwrap()[0].index, 0);
    assert_eq!(
        index.nearest(&[[0.5]], 2),
        Err(SearchError::Query(SoftDtwError::Overflow))
    );
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
        compare(squared(gamma), &candidates, &[query], n);
    }
}
