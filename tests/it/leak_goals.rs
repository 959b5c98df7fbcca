//! The goal estimator and the future: the fair query must not see it, the published one does.

use ddl_data::{OBSERVED, Position, WINDOW};
use ddl_goal::{GoalEstimatorParams, GoalSet};
use ddl_tests::{crowd, wild_future};

/// Goals, weights and experts, bit by bit.
fn bits(set: &GoalSet) -> Vec<u64> {
    let goals = set.goals().iter().flatten();
    let experts = set
        .experts()
        .iter()
        .flat_map(|expert| [expert.index as u64, expert.distance.to_bits()]);
    goals
        .chain(set.weights())
        .map(|number| number.to_bits())
        .chain(experts)
        .collect()
}

#[test]
fn fair_goals_do_not_depend_on_any_future_position() {
    let estimator = crowd::goal_estimator(GoalEstimatorParams::default());
    for window in crowd::windows(4, 6) {
        for i in 0..window.len() {
            let reference = bits(&estimator.estimate(window.observed(i)).unwrap());
            for (change, changed) in wild_future::all(&window) {
                let goals = estimator.estimate(changed.track(i)).unwrap();
                assert_eq!(
                    bits(&goals),
                    reference,
                    "{}@{} pedestrian {i}, future: {change}",
                    window.recording(),
                    window.start_frame()
                );
            }
        }
    }
}

/// The eighth difference of the published query ends at the first frame to be forecast: moving that
/// frame moves the goals, moving any later one does not.
#[test]
fn published_goals_read_frame_9_and_no_later_one() {
    let estimator = crowd::goal_estimator(GoalEstimatorParams::published());
    let away = |p: Position| [p[0] + 3.0, p[1] - 2.0];
    let (mut walkers, mut moved) = (0, 0);
    for window in crowd::windows(4, 6) {
        for i in 0..window.len() {
            let reference = bits(&estimator.estimate(window.track(i)).unwrap());
            for frame in OBSERVED..WINDOW {
                let changed = wild_future::replaced(&window, |pedestrian, t, p| {
                    if (pedestrian, t) == (i, frame) {
                        away(p)
                    } else {
                        p
                    }
                });
                let goals = bits(&estimator.estimate(changed.track(i)).unwrap());
                if frame == OBSERVED {
                    walkers += 1;
                    moved += usize::from(goals != reference);
                } else {
                    assert_eq!(goals, reference, "frame {}", frame + 1);
                }
            }
        }
    }
    assert!(walkers >= 8);
    assert_eq!(moved, walkers, "walkers whose goals frame 9 moves");
}

/// Without frame 9 the published query has nothing to stand on, and says so.
#[test]
fn published_goals_cannot_be_had_from_the_observation_alone() {
    let estimator = crowd::goal_estimator(GoalEstimatorParams::published());
    let window = &crowd::windows(1, 6)[0];
    let error = estimator.estimate(window.observed(0)).unwrap_err();
    assert!(error.to_string().contains('9'), "{error}");
}
