//! The promise of the dynamics, on the output of the whole model: every forecast comes nearer to its
//! goal at every step, and arrives when the flow is run on.

use ddl::data::{HORIZON, OBSERVED, PedestrianId, Position, TIME_STEP, Window};
use ddl::eval::metric::stability::RolloutStability;
use ddl::network::weights::load_weights;
use ddl::network::{ForecastWindows as _, MotionNetwork, Noise, StarConfig, StepRule};
use ddl::{Forecaster as _, Variant};
use ddl_tests::{crowd, tiny_model};

/// Rounding of `f32` at the coordinates of these scenes, metres, with room for a dozen operations: what
/// the network's own rollouts are held to. Forecasts are held to the letter.
const ROUNDING: f64 = 2e-5;

fn distance(a: Position, b: Position) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Whether each position is nearer to the goal than the one before, or within `arrived` metres of it.
fn comes_nearer(start: Position, path: &[Position], goal: Position, arrived: f64) -> bool {
    let mut before = distance(start, goal);
    path.iter().all(|&p| {
        let after = distance(p, goal);
        let nearer = after < before || after <= arrived;
        before = after;
        nearer
    })
}

#[test]
fn every_hypothesis_comes_nearer_to_its_goal_at_every_step() {
    let windows = crowd::windows(8, 12);
    for variant in [Variant::Full, Variant::NoGoalShift] {
        let tiny = tiny_model::of(variant);
        let forecasts = tiny.model.forecast_all(&windows).unwrap();
        for (window, forecast) in windows.iter().zip(&forecasts) {
            assert_eq!(forecast.hypotheses(), 20);
            for (i, k) in (0..window.len()).flat_map(|i| (0..20).map(move |k| (i, k))) {
                let start = window.observed(i)[OBSERVED - 1];
                let goal = forecast.goal(i, k).unwrap();
                let path = forecast.hypothesis(i, k);
                assert!(
                    comes_nearer(start, path, goal, 0.0),
                    "{variant}, {}@{} pedestrian {i}, goal {goal:?}: {path:?}",
                    window.recording(),
                    window.start_frame()
                );
                assert!(RolloutStability::of(start, path, goal).decreasing);
            }
        }
    }
}

/// Observations that no training scene holds: standing, on one spot together, a leap of 100 m.
fn strange_windows() -> Vec<Window> {
    let window = |tracks: Vec<Vec<Position>>| {
        let ids = (1..).map(PedestrianId).take(tracks.len()).collect();
        Window::new("strange", 0, 10, ids, tracks).unwrap()
    };
    let standing = vec![[3.0, -2.0]; OBSERVED];
    let mut leaping = standing.clone();
    leaping[OBSERVED - 1] = [103.0, -2.0];
    let zigzag: Vec<Position> = (0..OBSERVED)
        .map(|t| [if t % 2 == 0 { -2.0 } else { 2.0 }, 0.1 * t as f64])
        .collect();
    vec![
        window(vec![standing.clone()]),
        window(vec![standing.clone(), standing.clone()]),
        window(vec![leaping, zigzag, standing]),
    ]
}

#[test]
fn strange_observations_are_forecast_as_stably() {
    let tiny = tiny_model::of(Variant::Full);
    for window in strange_windows() {
        let forecast = tiny.model.forecast(&window).unwrap();
        for (i, k) in (0..window.len()).flat_map(|i| (0..20).map(move |k| (i, k))) {
            let start = window.observed(i)[OBSERVED - 1];
            let goal = forecast.goal(i, k).unwrap();
            let path = forecast.hypothesis(i, k);
            assert!(
                comes_nearer(start, path, goal, 0.0),
                "goal {goal:?}: {path:?}"
            );
        }
    }
}

/// A walker alone with a goal close ahead: what the two integrators make of it.
fn stable_share(network: &MotionNetwork, integrator: StepRule) -> f64 {
    let walking = (0..OBSERVED).map(|t| [0.5 * t as f64, 0.0]).collect();
    let window = Window::new("yard", 0, 10, vec![PedestrianId(1)], vec![walking]).unwrap();
    let start = window.observed(0)[OBSERVED - 1];
    let goals: Vec<Position> = (1..=20)
        .map(|k| [start[0] + 0.02 * f64::from(k), 0.01])
        .collect();
    let rollout = network
        .forecast_windows(
            std::slice::from_ref(&window),
            &[vec![goals.clone()]],
            Noise::Expected,
            integrator,
            None,
        )
        .unwrap()
        .remove(0);
    let paths = rollout.positions.chunks_exact(HORIZON);
    let stable = paths
        .zip(&goals)
        .filter(|(path, goal)| comes_nearer(start, path, **goal, ROUNDING));
    stable.count() as f64 / goals.len() as f64
}

/// Stability is the integrator's doing, whatever the weights, trained or not.
#[test]
fn plain_euler_steps_overshoot_where_stable_ones_do_not() {
    tiny_model::use_one_thread();
    let mut overshooting = 0;
    for seed in 0..4 {
        let config = StarConfig::published(Variant::Full);
        let network = MotionNetwork::new(config, seed).unwrap();
        let stable = stable_share(&network, StepRule::Bounded);
        assert!((stable - 1.0).abs() < f64::EPSILON, "seed {seed}: {stable}");
        overshooting += usize::from(stable_share(&network, StepRule::Euler) < 1.0);
    }
    assert!(
        overshooting > 0,
        "no network ever overshoots: the test shows nothing"
    );
}

/// The attractor need not be reached within 4.8 s. Run on, each forecast seen as the next
/// observation with the goal kept, the walker must arrive.
#[test]
fn run_on_every_walker_arrives() {
    let tiny = tiny_model::of(Variant::Full);
    let config = tiny.model.config();
    let network = MotionNetwork::new(config.star.clone(), 0).unwrap();
    let origin = tiny.model.config().network_origin();
    let file = tiny.model.run().unwrap().model();
    let weights = load_weights(network.weights().layout(), &origin, &file).unwrap();
    let network = network.with_weights(weights).unwrap();

    let first = crowd::windows(1, 4).remove(0).without_future();
    let forecast = tiny.model.forecast(&first).unwrap();
    let goals: Vec<Position> = (0..first.len())
        .map(|i| forecast.goal(i, forecast.most_likely(i)).unwrap())
        .collect();
    let given: Vec<Vec<Position>> = goals.iter().map(|&goal| vec![goal]).collect();
    let mut window = first.clone();
    let mut left = Vec::new();
    for _ in 0..MOST_ROUNDS {
        let rollout = network
            .forecast_windows(
                std::slice::from_ref(&window),
                std::slice::from_ref(&given),
                Noise::Expected,
                StepRule::Bounded,
                None,
            )
            .unwrap()
            .remove(0);
        let paths: Vec<&[Position]> = rollout.positions.chunks_exact(HORIZON).collect();
        for ((path, &goal), i) in paths.iter().zip(&goals).zip(0..) {
            let start = window.observed(i)[OBSERVED - 1];
            assert!(
                comes_nearer(start, path, goal, ROUNDING),
                "goal {goal:?}: {path:?}"
            );
        }
        let ends = paths.iter().zip(&goals);
        left = ends
            .map(|(path, &goal)| distance(path[HORIZON - 1], goal))
            .collect();
        let tracks = paths
            .iter()
            .map(|path| path[HORIZON - OBSERVED..].to_vec())
            .collect();
        window = Window::new("on", 0, 10, window.pedestrians().to_vec(), tracks).unwrap();
    }
    let seconds = MOST_ROUNDS as f64 * HORIZON as f64 * TIME_STEP;
    assert!(
        left.iter().all(|&distance| distance < ARRIVED),
        "distances left after {seconds} s: {left:?} m"
    );
}

/// Rollouts of 4.8 s, one after the other.
const MOST_ROUNDS: usize = 20;
/// Metres.
const ARRIVED: f64 = 0.01;
