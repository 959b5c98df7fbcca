//! The estimator on synthetic pedestrians: what it reads, what it depends on, what it returns.

use crate::tracks::{self, Positions, distance, walk};
use ddl_goal::{ExpertLibrary, GoalError, GoalEstimator, GoalEstimatorParams, QuerySpan, TrackError};
use proptest::prelude::*;

fn library() -> Vec<Positions> {
    let track = |i: u32| {
        let speed = f64::from(i % 20) * 0.08;
        let heading = f64::from(i / 20) * 0.31;
        walk(speed, heading, f64::from(i % 7) * 0.02 - 0.06)
    };
    (0..400).map(track).collect()
}

fn estimator(mut params: GoalEstimatorParams) -> GoalEstimator {
    (params.restarts, params.experts) = (2, 100);
    tracks::estimator(params, library())
}

fn both_frames() -> [GoalEstimatorParams; 2] {
    let query = QuerySpan::Observed;
    let world = GoalEstimatorParams { query, ..GoalEstimatorParams::published() };
    [GoalEstimatorParams::default(), world]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn nothing_after_the_eighth_position_is_read(
        speed in 0.0..1.6_f64, heading in -3.0..3.0_f64, turn in -0.1..0.1_f64,
        future in prop::collection::vec(
            prop::array::uniform2(prop_oneof![-50.0..50.0_f64, Just(f64::NAN), Just(f64::INFINITY)]), 0..12),
    ) {
        for params in both_frames() {
            let estimator = estimator(params);
            let track = walk(speed, heading, turn);
            let mut other = track[..8].to_vec();
            other.extend(&future);
            prop_assert_eq!(estimator.estimate(&track)?, estimator.estimate(&other)?);
        }
    }

    #[test]
    fn the_number_of_goals_is_the_requested_one_and_weights_sum_to_1(
        speed in prop_oneof![Just(0.0), 0.0..1.6_f64], heading in -3.0..3.0_f64,
        clusters in 1..40_usize,
    ) {
        for params in both_frames() {
            let goals = estimator(GoalEstimatorParams { clusters, ..params }).estimate(&walk(speed, heading, 0.0))?;
            prop_assert_eq!(goals.goals().len(), clusters);
            prop_assert_eq!(goals.weights().len(), clusters);
            prop_assert_eq!(goals.experts().len(), 100);
            prop_assert!((goals.weights().iter().sum::<f64>() - 1.0).abs() < 1e-12);
            prop_assert!(goals.weights().is_sorted_by(|a, b| a >= b));
            let likely = goals.weights()[0];
            prop_assert!(goals.weights().iter().all(|&weight| weight <= likely));
            for (i, &goal) in goals.goals().iter().enumerate() {
                let nearest = goals.nearest(goal);
                prop_assert!(nearest <= i && goals.goals()[nearest] == goal);
            }
        }
    }

    #[test]
    fn goals_move_with_the_pedestrian(
        speed in 0.0..1.6_f64, heading in -3.0..3.0_f64, by in prop::array::uniform2(-8_i32..8),
    ) {
        // Whole steps of 1/8 m move coordinates on a grid of 1/1024 m without rounding, so the velocities keep every
        // bit.
        let grid = |v: f64| (v * 1024.0).round() / 1024.0;
        let track: Positions = walk(speed, heading, 0.0).iter().map(|p| p.map(grid)).collect();
        let by = by.map(|v| f64::from(v) / 8.0);
        let moved: Positions = track.iter().map(|p| [p[0] + by[0], p[1] + by[1]]).collect();
        for params in both_frames() {
            let estimator = estimator(params);
            let (here, there) = (estimator.estimate(&track)?, estimator.estimate(&moved)?);
            prop_assert_eq!(here.experts(), there.experts());
            for (a, b) in here.goals().iter().zip(there.goals()) {
                prop_assert!((a[0] + by[0] - b[0]).abs() < 1e-12 && (a[1] + by[1] - b[1]).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn the_published_query_reads_the_ninth_position_and_no_further() {
    let estimator = estimator(GoalEstimatorParams::published());
    let track = walk(1.0, 0.3, 0.0);
    let with = |index: usize| {
        let mut changed = track.clone();
        changed[index][0] += 0.5;
        estimator.estimate(&changed).unwrap()
    };
    let original = estimator.estimate(&track).unwrap();
    assert_ne!(with(8), original);
    assert!((9..20).all(|index| with(index) == original));
}

#[test]
fn a_pedestrian_finds_itself_and_goals_near_where_it_goes() {
    for params in [GoalEstimatorParams::default(), GoalEstimatorParams::published()] {
        let estimator = estimator(params);
        let track = estimator.library().tracks()[237].clone();
        let goals = estimator.estimate(&track).unwrap();
        // In its own frame a pedestrian resembles itself, and every pedestrian that walks the same way elsewhere or
        // mirrored.
        let mut itself = goals.experts().iter().take_while(|e| e.distance == 0.0);
        assert!(itself.any(|e| (e.index, e.mirrored) == (237, false)));
        let nearest = goals.goals()[goals.nearest(track[19])];
        let miss = distance(nearest, track[19]);
        assert!(miss < 1.0, "{miss} m");
    }
}

#[test]
fn results_do_not_depend_on_batches_or_threads() {
    let track = |i: u32| walk(0.05 * f64::from(i), 0.2 * f64::from(i), 0.01);
    let tracks: Vec<Positions> = (0..30).map(track).collect();
    for params in both_frames() {
        let estimator = estimator(params);
        let alone: Vec<_> = tracks.iter().map(|track| estimator.estimate(track).unwrap()).collect();
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let batch = |slices: &[&[[f64; 2]]]| pool.install(|| estimator.estimate_batch(slices)).unwrap();
            let mut slices: Vec<&[[f64; 2]]> = tracks.iter().map(Vec::as_slice).collect();
            assert_eq!(batch(&slices), alone);
            slices.reverse();
            assert!(batch(&slices).iter().rev().eq(&alone));
        }
    }
}

#[test]
fn the_seed_decides_in_the_frame_of_the_world_only() {
    let track = walk(1.1, 0.4, 0.01);
    let [own, world] = both_frames().map(|params| {
        (1..12)
            .map(|seed| estimator(GoalEstimatorParams { seed, ..params.clone() }).estimate(&track).unwrap())
            .collect::<Vec<_>>()
    });
    assert!(own.iter().all(|set| set == &own[0]));
    assert!(world.iter().any(|set| set != &world[0]), "k-means ignores the seed");
    assert!(world.iter().all(|set| set.experts() == world[0].experts()));
}

/// A rounding error may change the order of two equally near experts, or a tie of k-means, for a few pedestrians.
#[test]
fn rounding_errors_move_goals_only_slightly() {
    for params in both_frames() {
        let estimator = estimator(params);
        let mut moved = 0;
        for i in 0..60_u32 {
            let t = f64::from(i);
            let track = walk(0.2 + 0.023 * t, 0.11 * t, 0.0007 * t);
            let error = |step: usize| if step.is_multiple_of(2) { 1e-9 } else { -1e-9 };
            let nudged = |s: usize| [track[s][0] + error(s), track[s][1] - error(s)];
            let nudged: Positions = (0..8).map(nudged).collect();
            let [a, b] = [&track, &nudged].map(|track| estimator.estimate(track).unwrap());
            let goals = b.goals().iter();
            let furthest = goals.map(|&goal| distance(a.goals()[a.nearest(goal)], goal));
            moved += u32::from(furthest.fold(0.0, f64::max) > 1e-6);
        }
        assert!(moved <= 3, "goals of {moved} of 60 pedestrians moved");
    }
}

#[test]
fn invalid_input_is_reported() {
    let refused = |experts| {
        let params = GoalEstimatorParams { experts, ..GoalEstimatorParams::published() };
        GoalEstimator::new(params, ExpertLibrary::new(library(), 0.4).unwrap()).unwrap_err()
    };
    let (tracks, experts) = (400, 401);
    assert_eq!(refused(experts), GoalError::TooFewTracks { tracks, experts });
    assert!(matches!(refused(0), GoalError::Params(_)));

    let estimator = estimator(GoalEstimatorParams::default());
    let track = walk(1.0, 0.0, 0.0);
    // The heading frame accepts fewer tracks.
    let params = GoalEstimatorParams { experts: 1_000, ..Default::default() };
    let goals = tracks::estimator(params, library()).estimate(&track);
    assert_eq!(goals.unwrap().goals().len(), 20);
    let (positions, needed) = (7, 8);
    let short = GoalError::Track(TrackError::TooShort { positions, needed });
    assert_eq!(estimator.estimate(&track[..7]), Err(short.clone()));
    let source = Box::new(short);
    let batch = estimator.estimate_batch(&[&track, &track[..7]]);
    assert_eq!(batch, Err(GoalError::BatchTrack { index: 1, source }));
    let far = [[0.0, 0.0], [1e308, 0.0]].repeat(4);
    let error = estimator.estimate(&far).unwrap_err().to_string();
    assert!(error.contains("too long for a velocity"), "{error}");
    let mut broken = track;
    broken[3][1] = f64::NAN;
    assert_eq!(
        estimator.estimate(&broken).unwrap_err().to_string(),
        "the observed track: position 3 is (1.2000000000000002, NaN): must be finite"
    );
    assert_eq!(estimator.params().query, QuerySpan::Observed);
}
