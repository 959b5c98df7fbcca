//! The leak test itself: forecasters that look ahead, each in another way, are all found.

use ddl_data::{OBSERVED, Position, WINDOW, Window};
use ddl_eval::baseline::{StraightLine, TrueEnd};
use ddl_eval::{Forecast, ForecastError, Forecaster, Protocol, leak};
use ddl_goal::GoalEstimatorParams;
use ddl_tests::{bits, crowd, goal_lines, wild_future};

/// Constant velocity that lets itself be pushed a little by what it should not know.
struct Peeks {
    at: fn(&Window, usize) -> Option<Position>,
}

impl Forecaster for Peeks {
    fn name(&self) -> String {
        "peeks".to_owned()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        let mut positions = Vec::new();
        for i in 0..window.len() {
            let [before, last] = [OBSERVED - 2, OBSERVED - 1].map(|t| window.observed(i)[t]);
            // so little that no metric would show it
            let push = (self.at)(window, i).map_or(0.0, |seen| 1e-12 * seen[0]);
            positions.extend((1..=WINDOW - OBSERVED).map(|t| {
                let t = t as f64;
                [
                    last[0] + t * (last[0] - before[0]) + push,
                    last[1] + t * (last[1] - before[1]),
                ]
            }));
        }
        Ok(Forecast::equally_likely(window.len(), 1, positions)?)
    }
}

fn is_caught(forecaster: &dyn Forecaster, window: &Window) -> bool {
    leak::find(forecaster, window).unwrap().is_some()
}

#[test]
fn a_glimpse_of_one_future_position_is_caught() {
    let window = &crowd::windows(1, 6)[0];
    let own_next = Peeks {
        at: |window, i| window.future(i).first().copied(),
    };
    let own_last = Peeks {
        at: |window, i| window.end(i),
    };
    let of_the_next_pedestrian = Peeks {
        at: |window, i| window.future((i + 1) % window.len()).get(5).copied(),
    };
    for peeking in [own_next, own_last, of_the_next_pedestrian] {
        assert!(is_caught(&peeking, window));
    }
    let honest = Peeks {
        at: |window, i| window.observed(i).first().copied(),
    };
    assert!(!is_caught(&honest, window));
}

/// The replaced futures of the direct tests catch it too: they are no weaker than `leak::find`.
#[test]
fn every_wild_future_shows_the_glimpse() {
    let window = &crowd::windows(1, 6)[0];
    let peeking = Peeks {
        at: |window, i| window.future(i).get(3).copied(),
    };
    let reference = bits::of(&peeking.forecast(&window.without_future()).unwrap());
    for (change, changed) in wild_future::all(window) {
        // a NaN that is read makes a forecast that cannot even be built
        let same = peeking
            .forecast(&changed)
            .is_ok_and(|forecast| bits::of(&forecast) == reference);
        assert!(!same || change == "the origin", "future: {change}");
    }
}

/// The published query, behind a forecaster that does without it when it must: only the changed
/// future gives it away.
#[test]
fn the_published_goal_query_is_caught() {
    struct PublishedWhenItCan {
        published: goal_lines::EstimatedGoals,
        fair: goal_lines::EstimatedGoals,
    }
    impl Forecaster for PublishedWhenItCan {
        fn name(&self) -> String {
            "published goals when it can".to_owned()
        }
        fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
            let source = if window.has_future() {
                &self.published
            } else {
                &self.fair
            };
            StraightLine::to(source).forecast(window)
        }
    }
    let goals = |params| goal_lines::EstimatedGoals(crowd::goal_estimator(params));
    let forecaster = PublishedWhenItCan {
        published: goals(GoalEstimatorParams::published()),
        fair: goals(GoalEstimatorParams::default()),
    };
    let windows = crowd::windows(1, 4);
    assert!(is_caught(&forecaster, &windows[0]));
    // the protocols cut the future off before it can be read: even this one is honest under them
    for protocol in [Protocol::Fair, Protocol::Single] {
        let shown = protocol.forecast(&forecaster, &windows).unwrap();
        let changed = wild_future::all(&windows[0]).swap_remove(0).1;
        let again = protocol.forecast(&forecaster, &[changed]).unwrap();
        assert_eq!(bits::of_all(&shown), bits::of_all(&again), "{protocol}");
    }
}

/// Who cannot forecast without the future says so, and is refused under `fair` and `single`.
#[test]
fn who_needs_the_future_is_refused() {
    let windows = crowd::windows(1, 6);
    let published =
        goal_lines::to_goals_of(crowd::goal_estimator(GoalEstimatorParams::published()));
    let oracle = StraightLine::to(TrueEnd);
    for forecaster in [&published as &dyn Forecaster, &oracle] {
        assert!(leak::find(forecaster, &windows[0]).is_err());
        assert!(Protocol::Published.forecast(forecaster, &windows).is_ok());
        for protocol in [Protocol::Fair, Protocol::Single] {
            assert!(protocol.forecast(forecaster, &windows).is_err());
        }
    }
}
