//! What half precision in the feed-forward blocks changes about forecasts.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use ddl_data::{Dataset, OBSERVED, Position, Window, WindowRule};
use ddl_network::{
    ForecastWindows as _, MotionNetwork, Noise, Precision, StarConfig, StepRule, Variant,
};

fn forecasts(network: &MotionNetwork) -> Vec<Position> {
    let windows = Dataset::simulated(1).recordings()[0].windows(WindowRule::Complete);
    let windows: Vec<Window> = windows.iter().take(4).map(Window::without_future).collect();
    let goal = |window: &Window, i: usize| {
        let [x, y] = window.observed(i)[OBSERVED - 1];
        vec![[x + 3.0, y - 1.0]]
    };
    let of_window = |window: &Window| -> Vec<Vec<Position>> {
        (0..window.len()).map(|i| goal(window, i)).collect()
    };
    let goals: Vec<_> = windows.iter().map(of_window).collect();
    let rollouts = network
        .forecast_windows(&windows, &goals, Noise::Expected, StepRule::Bounded, None)
        .unwrap();
    rollouts
        .into_iter()
        .flat_map(|rollout| rollout.positions)
        .collect()
}

/// Forecasts differ by little, and the weights are those of before: packed again in single precision they give the same.
#[test]
fn half_precision_changes_forecasts_a_little_and_weights_not_at_all() {
    let config = StarConfig {
        feed_forward_width: 96,
        ..StarConfig::published(Variant::Full)
    };
    let mut network = MotionNetwork::new(config, 3).unwrap();
    let weights = network.weights().clone();
    let mut found = Vec::new();
    for precision in [Precision::F32, Precision::Bf16, Precision::F32] {
        network = network.in_precision(precision);
        assert_eq!(network.precision(), precision);
        assert_eq!(network.weights(), &weights);
        found.push(forecasts(&network));
        // Other weights are packed in the same precision.
        network = network.with_weights(weights.clone()).unwrap();
        assert_eq!(network.precision(), precision);
        assert_eq!(&forecasts(&network), found.last().unwrap());
    }
    assert_eq!(found[0], found[2]);
    let pairs = found[0].iter().zip(&found[1]);
    let difference = pairs
        .map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]))
        .fold(0.0, f64::max);
    assert!(difference > 1e-7 && difference < 0.05, "{difference} m");
}
