//! Experts carried over to the walker end where the goals were taken from.

use ddl_goal::GoalEstimatorParams;

use crate::tracks::{distance, estimator, walk};

/// A walker who is an expert, turned and moved, goes where the expert went; its mirror image mirrored.
#[test]
fn the_same_walk_is_carried_onto_itself() {
    let (speed, turn) = (1.1, 0.06);
    let params = GoalEstimatorParams::default().experts(2).clusters(2);
    let estimator = estimator(params, vec![walk(speed, 0.0, turn)]);
    for (walker, mirrored) in [
        (walk(speed, 1.0, turn), false),
        (walk(speed, 1.0, -turn), true),
    ] {
        let expert = estimator.estimate(&walker).unwrap().experts()[0];
        assert_eq!(expert.mirrored, mirrored);
        let carried = estimator.carry_over(&expert, &walker).unwrap();
        for (&carried, &own) in carried.iter().zip(&walker) {
            assert!(distance(carried, own) < 1e-9, "{carried:?} {own:?}");
        }
        assert!(estimator.carry_over(&expert, &[[0.0; 2]; 5]).is_err());
    }
}

/// In the frame of the world the expert's track is moved to the first position and nothing else.
#[test]
fn in_the_world_a_track_is_moved_to_where_the_pedestrian_was_first_seen() {
    let (other, walker) = (walk(1.2, 0.3, 0.05), walk(1.0, 2.0, -0.04));
    let params = GoalEstimatorParams::published().experts(1).clusters(1);
    let estimator = estimator(params, vec![other.clone()]);
    let expert = estimator.estimate(&walker).unwrap().experts()[0];
    assert!(estimator.carry_over(&expert, &walker[..7]).is_err());
    let carried = estimator.carry_over(&expert, &walker[..8]).unwrap();
    let by = [0, 1].map(|axis| walker[0][axis] - other[0][axis]);
    for (carried, [x, y]) in carried.into_iter().zip(other) {
        assert!(distance(carried, [x + by[0], y + by[1]]) < 1e-12);
    }
}
