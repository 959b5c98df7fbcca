//! Bounded rollouts end on the goal within the top speed, and a rollout's factors reproduce its steps.

use super::scenes::{Question, WINDOWS, configs, distance, goals};
use ddl_core::{HORIZON, OBSERVED, Position, Window};
use ddl_dynamics::{Attractor, CholeskyMetric, Euler, NaturalGradientFlow, StableEuler, StepTime, rollout};
use ddl_network::{ForecastWindows as _, MotionNetwork, NetworkFrame, Noise, StarConfig, StepRule, motion_bounds};
use nalgebra::Vector2;
use proptest::prelude::*;
use proptest::sample::Index;

/// Bound of the rounding of positions to `f32` over twelve steps, some ten metres from the origin (m).
const ROUNDING: f64 = 1e-4;

fn with_dynamics() -> Vec<StarConfig> {
    configs().into_iter().filter(|config| config.variant.dynamics()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn the_last_step_ends_on_the_goal_and_none_is_too_fast(
        config in prop::sample::select(with_dynamics()),
        seed in any::<u64>(),
        window in any::<Index>(),
        (angle, reach) in (0.0..std::f64::consts::TAU, 0.0..0.999_f64),
        share in 0.0..=1.0_f64,
        drawn in any::<bool>(),
    ) {
        let dt = config.time_step;
        let network = MotionNetwork::new(config, seed).unwrap();
        let window = window.get(&WINDOWS).without_future();
        let top = |i: usize| motion_bounds(window.observed(i), dt, 1.0).top_speed();
        let goal = |i: usize| {
            let ([x, y], way) = (window.observed(i)[OBSERVED - 1], reach * HORIZON as f64 * dt * top(i));
            let (sin, cos) = (angle + i as f64).sin_cos();
            [x + way * cos, y + way * sin]
        };
        let goals: Vec<Vec<Position>> = (0..window.len()).map(|i| vec![goal(i)]).collect();
        let shares = [vec![share; window.len()]];
        let noise = if drawn { Noise::Draws { count: 1, seed } } else { Noise::Expected };
        let rollout = &network
            .forecast_windows(std::slice::from_ref(&window), &[goals], noise, StepRule::Bounded, Some(&shares))
            .unwrap()[0];
        for (i, path) in rollout.positions.chunks_exact(HORIZON).enumerate() {
            let mut here = window.observed(i)[OBSERVED - 1];
            for &next in path {
                let step = distance(here, next);
                prop_assert!(step <= top(i) * dt + ROUNDING, "{step} m, {} m/s", top(i));
                prop_assert!(distance(next, goal(i)) <= distance(here, goal(i)) + ROUNDING);
                here = next;
            }
            let off = distance(here, goal(i));
            prop_assert!(off < ROUNDING, "{off} m off");
        }
    }
}

/// The step after `done` steps, by `ddl-dynamics` in f64 with an emitted factor, of a pedestrian with these observed
/// positions.
fn step(
    (from, goal): (Position, Position),
    [a, b, c]: [f64; 3],
    (config, rule): (&StarConfig, StepRule),
    (observed, done): (&[Position], usize),
) -> Position {
    let (start, dt): (Vector2<f64>, f64) = (from.into(), config.time_step);
    let attractor = Attractor::new(goal.into()).unwrap();
    let metric = CholeskyMetric::planar(a, b, c, config.sigma).unwrap();
    let path = match rule {
        StepRule::Euler => {
            let flow = NaturalGradientFlow::new(attractor, metric);
            rollout(&flow, &Euler, start, dt, 1)
        }
        StepRule::Bounded => {
            let bounds = motion_bounds(observed, dt, 1.0);
            let bounds = match config.frame {
                NetworkFrame::World => bounds.absolute(),
                NetworkFrame::Goal => bounds,
            };
            let left = HORIZON - done;
            let time = StepTime { done, left, dt };
            let metric = bounds.shape(&metric, &(attractor.goal() - start), time);
            let flow = NaturalGradientFlow::new(attractor, metric);
            rollout(&flow, &StableEuler, start, dt, 1)
        }
    };
    path.unwrap()[1].into()
}

#[test]
fn factors_reproduce_the_steps() {
    let windows: Vec<&Window> = WINDOWS.iter().take(8).collect();
    for config in with_dynamics() {
        let network = MotionNetwork::new(config.clone(), 5).unwrap();
        for rule in [StepRule::Euler, StepRule::Bounded] {
            let mut compared = 0;
            let question = Question { rule, ..Question::bounded(3) };
            for (window, rollout) in windows.iter().zip(question.ask(&network, &windows)) {
                let goals = goals(window, 3);
                let factors = rollout.factors.unwrap();
                assert_eq!(factors.len(), rollout.positions.len());
                assert_eq!(factors.len(), window.len() * 3 * HORIZON);
                let shaped = rollout.positions.chunks_exact(HORIZON).zip(factors.chunks_exact(HORIZON));
                for (pair, (path, factors)) in shaped.enumerate() {
                    let (i, k) = (pair / 3, pair % 3);
                    let mut here = window.observed(i)[OBSERVED - 1];
                    for (done, (&next, &factor)) in path.iter().zip(factors).enumerate() {
                        let goal = goals[i][k];
                        let seen = (window.observed(i), done);
                        let expected = step((here, goal), factor, (&config, rule), seen);
                        let off = distance(next, expected);
                        // Close to the goal the result of an Euler step depends on rounding.
                        let undecided = rule == StepRule::Euler && distance(here, goal) < 1e-2;
                        assert!(off < 1e-4 || undecided, "{config:?}, {rule:?}: {off} m off");
                        compared += usize::from(!undecided);
                        here = next;
                    }
                }
            }
            let pedestrians: usize = windows.iter().map(|window| window.len()).sum();
            assert!(compared > pedestrians * 3 * HORIZON / 2);
        }
    }
}
