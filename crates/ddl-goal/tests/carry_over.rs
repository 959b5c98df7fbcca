//! Experts carried over to the walker end where the goals were taken from.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use ddl_goal::{ExpertLibrary, GoalEstimator, GoalEstimatorParams};

/// A walker who starts at an angle and bends by `bend` radians a step.
fn walk(angle: f64, bend: f64, speed: f64) -> Vec<[f64; 2]> {
    let mut place = [3.0 * angle, -2.0 * speed];
    (0..20)
        .map(|step| {
            let heading = angle + bend * f64::from(step);
            place = [
                place[0] + 0.4 * speed * heading.cos(),
                place[1] + 0.4 * speed * heading.sin(),
            ];
            place
        })
        .collect()
}

fn close(a: [f64; 2], b: [f64; 2]) -> bool {
    (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9
}

/// With one expert and one goal, the goal is the end of the expert carried over.
#[test]
fn one_expert_is_the_goal() {
    let library = ExpertLibrary::new(vec![walk(0.3, 0.05, 1.2)], 0.4).unwrap();
    let walker = walk(2.0, -0.04, 1.0);
    for params in [
        GoalEstimatorParams::default().experts(1).clusters(1),
        GoalEstimatorParams::published().experts(1).clusters(1),
    ] {
        let estimator = GoalEstimator::new(params.check().unwrap(), library.clone()).unwrap();
        let set = estimator.estimate(&walker).unwrap();
        let carried = estimator.carry_over(&set.experts()[0], &walker).unwrap();
        assert_eq!(carried.len(), 20);
        assert!(close(carried[19], set.goals()[0]), "{carried:?} {set:?}");
    }
}

/// A walker who is an expert, turned and moved, goes where the expert went; its mirror image mirrored.
#[test]
fn the_same_walk_is_carried_onto_itself() {
    let (bend, speed) = (0.06, 1.1);
    let library = ExpertLibrary::new(vec![walk(0.0, bend, speed)], 0.4).unwrap();
    let params = GoalEstimatorParams::default().experts(2).clusters(2);
    let estimator = GoalEstimator::new(params.check().unwrap(), library).unwrap();
    for (walker, mirrored) in [
        (walk(1.0, bend, speed), false),
        (walk(1.0, -bend, speed), true),
    ] {
        let set = estimator.estimate(&walker).unwrap();
        let expert = set.experts()[0];
        assert_eq!(expert.mirrored, mirrored);
        let carried = estimator.carry_over(&expert, &walker).unwrap();
        for (carried, own) in carried.iter().zip(&walker) {
            assert!(close(*carried, *own), "{carried:?} {own:?}");
        }
    }
    let set = estimator.estimate(&walk(1.0, bend, speed)).unwrap();
    assert!(
        estimator
            .carry_over(&set.experts()[0], &[[0.0; 2]; 5])
            .is_err()
    );
}
